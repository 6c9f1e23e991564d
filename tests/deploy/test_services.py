"""Services, scripts and requirements of the line PC, read without installing them."""

import hashlib
import shutil
import subprocess
from pathlib import Path

import pytest

from deploy.bundle.systems import LIBRARIES, SYSTEMS, platforms
from deploy.bundle.wheels import pinned, requirements
from tests.conftest import ROOT

FILES = ROOT / "deploy" / "bundle" / "files"


def test_install_sh_knows_the_systems_of_the_bundle() -> None:
    text = (FILES / "install.sh").read_text()
    for name, system in SYSTEMS.items():
        assert f"{name}) python={system.python} ;;" in text
        assert platforms(system)[0] == f"manylinux_2_{system.glibc_minor}_x86_64"


def test_the_line_pc_gets_neither_renderer_nor_training() -> None:
    names = {item.split(">")[0].split("=")[0] for item in requirements(ROOT)}
    assert {"numpy", "onnxruntime", "pypylon", "PySide6-Essentials", "cryptography"} <= names
    assert not names & {"mitsuba", "torch", "matplotlib", "distributed", "scikit-learn"}


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze")
def test_the_engine_s_service_is_closed_off() -> None:
    unit = FILES / "weldgate-engine.service"
    command = ["systemd-analyze", "security", "--offline=true", "--threshold=29", "--no-pager", unit]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout.splitlines()[-1:]


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="needs systemd-analyze")
@pytest.mark.parametrize("name", ["weldgate-engine.service", "weldgate-window.service"])
def test_systemd_understands_the_services(name: str, tmp_path: Path) -> None:
    text = (FILES / name).read_text()
    for program in ("/opt/weldgate/current/bin/weldgate", "/usr/bin/xinit"):
        text = text.replace(f"ExecStart={program}", "ExecStart=/bin/true")
    (tmp_path / "weldgate-engine.service").write_text((FILES / "weldgate-engine.service").read_text())
    (tmp_path / name).write_text(text)
    done = subprocess.run(
        ["systemd-analyze", "verify", tmp_path / name],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    own = [text for text in done.stderr.splitlines() if name in text and "not executable" not in text]
    assert not own, own


def test_the_scripts_are_clean() -> None:
    shellcheck = shutil.which("shellcheck")
    for script in FILES.glob("*.sh"):
        assert subprocess.run(["sh", "-n", script], check=False, timeout=60).returncode == 0
        if shellcheck:
            done = subprocess.run(
                [shellcheck, script], capture_output=True, text=True, check=False, timeout=60
            )
            assert done.returncode == 0, done.stdout


def test_requirements_carry_the_hash_of_each_wheel(tmp_path: Path) -> None:
    wheel = tmp_path / "weldgate-1.0.0-py3-none-any.whl"
    wheel.write_bytes(b"wheel")
    expected = hashlib.sha256(b"wheel").hexdigest()
    assert pinned([wheel]) == f"weldgate==1.0.0 --hash=sha256:{expected}\n"


def test_libraries_of_the_line_pc_are_those_of_the_checkout_without_the_renderer() -> None:
    lines = (ROOT / "deploy" / "system.sh").read_text().split("needed=(")[1].split(")")[0].split()
    assert {tuple(line.split("=")) for line in lines} - set(LIBRARIES) == {("libLLVM.so.19.1", "libllvm19")}

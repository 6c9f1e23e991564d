"""The wheel, built and installed for real next to somebody else's packages named like the rooms."""

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import venv
from collections.abc import Sequence
from importlib.metadata import PathDistribution
from pathlib import Path
from zipfile import ZipFile

import pytest

from tests.conftest import ROOT
from tests.parts import FRAMES, labels

ROOMS = ("station", "synth", "models", "deploy")
FOREIGN = 'raise RuntimeError("somebody else\'s package was imported")\n'
COMMANDS = ("weldgate", "weldgate-synth", "weldgate-models", "weldgate-demo")


def run(
    command: Sequence[str | Path], folder: Path, **environment: str
) -> "subprocess.CompletedProcess[str]":
    clean = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
    return subprocess.run(
        command,
        cwd=folder,
        env={**clean, **environment},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def pip(folder: Path, *arguments: str | Path) -> None:
    done = run([sys.executable, "-m", "pip", "-q", "--disable-pip-version-check", *arguments], folder)
    assert done.returncode == 0, done.stderr


def foreign(folder: Path) -> None:
    for room in ROOMS:
        (folder / room).mkdir(parents=True)
        (folder / room / "__init__.py").write_text(FOREIGN)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this checkout, built in a copy of it."""
    source = tmp_path_factory.mktemp("source")
    for name in ROOMS:
        shutil.copytree(ROOT / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, source)
    pip(source, "wheel", "--no-deps", "--no-index", "--no-build-isolation", "-w", source / "dist", source)
    (built,) = (source / "dist").glob("*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment in which other packages have the rooms' names, and weldgate is installed."""
    home = tmp_path_factory.mktemp("home")
    venv.create(home, with_pip=False, symlinks=os.name == "posix")
    packages = Path(sysconfig.get_path("purelib", "venv", {"base": str(home), "platbase": str(home)}))
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    foreign(packages)
    pip(home, "--python", home, "install", "--no-deps", "--no-index", wheel)
    assert all((packages / room / "__init__.py").read_text() == FOREIGN for room in ROOMS)
    return Path(sysconfig.get_path("scripts", "venv", {"base": str(home), "platbase": str(home)}))


@pytest.fixture
def hostile(tmp_path: Path) -> Path:
    """A folder of other packages of these names, to work in and to have ahead on PYTHONPATH."""
    foreign(tmp_path / "other")
    return tmp_path / "other"


def test_a_wheel_holds_one_package_with_every_file_of_the_rooms(wheel: Path) -> None:
    with ZipFile(wheel) as archive:
        names = archive.namelist()
    assert {name.split("/")[0] for name in names} == {"weldgate", "weldgate-0.1.0.dist-info"}
    expected = {path.relative_to(ROOT).as_posix() for room in ROOMS for path in (ROOT / room).rglob("*.py")}
    expected |= {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "station").rglob("*")
        if path.suffix in (".j2", ".css", ".qm")
    }
    expected |= {
        f"{room}/shipped/{path.name}"
        for room in ("models", "synth")
        for path in (ROOT / room / "shipped").iterdir()
    }
    expected |= {
        "models/evaluation/report.html.j2",
        "deploy/station.toml",
        "deploy/records.md",
        *(path.relative_to(ROOT).as_posix() for path in (ROOT / "deploy" / "bundle" / "files").iterdir()),
        *(
            path.relative_to(ROOT).as_posix()
            for path in (ROOT / "deploy" / "plc").iterdir()
            if path.is_file()
        ),
        *(path.relative_to(ROOT).as_posix() for path in (ROOT / "deploy" / "docs").glob("*.md")),
        *(path.relative_to(ROOT).as_posix() for path in (ROOT / "deploy" / "docs" / "how-to").glob("*.md")),
        *(f"deploy/frames/{path.name}" for path in FRAMES.iterdir()),
    }
    own = {name for name in expected if name.startswith("deploy/package/weldgate/")}
    assert expected - own == {
        name.removeprefix("weldgate/") for name in names if name.count("/") > 1 and "dist-info" not in name
    }


def test_every_command_runs_next_to_foreign_packages(installed: Path, hostile: Path) -> None:
    for name in COMMANDS:
        done = run([installed / name, "--help"], hostile, PYTHONPATH=str(hostile))
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith(f"usage: {name} ")
    done = run([installed / "python", "-P", "-m", "weldgate", "--version"], hostile, PYTHONPATH=str(hostile))
    assert done.stdout == "weldgate 0.1.0\n"


def test_spawned_workers_find_the_installed_rooms(installed: Path, hostile: Path) -> None:
    frames = [FRAMES / item["frame"] for item in labels()]
    assert len(frames) >= 4, "fewer are judged without workers"
    command = [installed / "weldgate", "replay", *frames, "--processes", "2", "--json", "out.json"]
    done = run(command, hostile, PYTHONPATH=str(hostile))
    assert done.returncode == 0, done.stderr
    found = json.loads((hostile / "out.json").read_text())
    assert [entry["verdict"] for entry in found.values()] == [item["verdict"] for item in labels()]


CHILD = """
import subprocess, sys, weldgate
weldgate.find_rooms()
from station.files.installation import room_command
sys.exit(subprocess.run([*room_command("station"), "--version"]).returncode)
"""


def test_a_room_started_as_a_process_of_its_own_is_the_installed_one(installed: Path, hostile: Path) -> None:
    done = run([installed / "python", "-P", "-c", CHILD], hostile, PYTHONPATH=str(hostile))
    assert (done.returncode, done.stdout) == (0, "weldgate 0.1.0\n"), done.stderr


def test_a_worker_of_a_cluster_finds_the_installed_rooms_once_prepared(
    installed: Path, hostile: Path
) -> None:
    code = "import weldgate; weldgate.dask_setup(None); import synth; print(synth.__doc__ is not None)"
    done = run([installed / "python", "-P", "-c", code], hostile, PYTHONPATH=str(hostile))
    assert done.stdout == "True\n", done.stderr


def test_other_programs_still_find_their_own_packages(installed: Path, hostile: Path) -> None:
    (hostile / "models" / "__init__.py").write_text("WHOSE = 'theirs'\n")
    code = "import weldgate, models; print(models.WHOSE)"
    done = run([installed / "python", "-c", code], hostile, PYTHONPATH=str(hostile))
    assert done.stdout == "theirs\n", done.stderr


def test_a_foreign_package_that_is_loaded_already_is_refused_in_one_line(
    installed: Path, hostile: Path
) -> None:
    (hostile / "models" / "__init__.py").write_text("")
    (hostile / "sitecustomize.py").write_text("import models\n")
    done = run([installed / "weldgate", "--version"], hostile, PYTHONPATH=str(hostile))
    assert done.returncode == 2
    assert done.stderr.splitlines() == [
        f"weldgate: another package named models is already loaded: {hostile / 'models' / '__init__.py'}. "
        "Start weldgate without it."
    ]


def test_the_metadata_claims_no_names_of_others(installed: Path) -> None:
    (info,) = installed.parent.rglob("weldgate-*.dist-info")
    assert not PathDistribution(info).read_text("top_level.txt")
    assert {entry.name for entry in PathDistribution(info).entry_points} == set(COMMANDS)

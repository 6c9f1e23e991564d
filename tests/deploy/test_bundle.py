"""The offline bundle, installed by its own scripts below another folder, with one small wheel."""

import hashlib
import os
import shutil
import signal
import subprocess
import sys
from base64 import urlsafe_b64encode
from pathlib import Path
from zipfile import ZipFile

import pytest

from deploy.bundle import __main__ as bundle
from deploy.bundle.systems import SYSTEMS
from deploy.bundle.wheels import BundleError
from tests.conftest import ROOT

PYTHON = f"{sys.version_info.major}.{sys.version_info.minor}"
SYSTEM = next((name for name, system in SYSTEMS.items() if system.python == PYTHON), None)
pytestmark = pytest.mark.skipif(
    SYSTEM is None or shutil.which("flock") is None,
    reason="needs the Python of a supported system, and flock",
)
CODE = """
import sys
from pathlib import Path
def run():
    print("weldgate {version}")
    return 0
"""
READ = "import sys; sys.exit(2 if 'refuse-{version}' in open(sys.argv[1]).read() else 0)\n"


def make_wheel(folder: Path, version: str, start: str = "") -> Path:
    """A wheel with the command, the networks' folder and the settings file of weldgate, and nothing else."""
    files = {
        "weldgate/__init__.py": CODE.format(version=version) + start,
        "weldgate/deploy/__init__.py": "",
        "weldgate/deploy/bundle/__init__.py": "",
        "weldgate/deploy/bundle/read_settings.py": READ.format(version=version),
        "weldgate/deploy/station.toml": (ROOT / "deploy" / "station.toml").read_text(),
        "weldgate/station/__init__.py": "",
        "weldgate/station/files/installation.py": (ROOT / "station/files/installation.py").read_text(),
        "weldgate/models/shipped/weldgate.onnx": "",
        f"weldgate-{version}.dist-info/METADATA": (
            f"Metadata-Version: 2.1\nName: weldgate\nVersion: {version}\n"
        ),
        f"weldgate-{version}.dist-info/WHEEL": (
            "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n"
        ),
        f"weldgate-{version}.dist-info/entry_points.txt": "[console_scripts]\nweldgate = weldgate:run\n",
    }
    path = folder / f"weldgate-{version}-py3-none-any.whl"
    record = ""
    with ZipFile(path, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
            digest = urlsafe_b64encode(hashlib.sha256(text.encode()).digest()).rstrip(b"=").decode()
            record += f"{name},sha256={digest},{len(text.encode())}\n"
        archive.writestr(f"weldgate-{version}.dist-info/RECORD", record)
    return path


@pytest.fixture(scope="module")
def pip_wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """pip as a file that Python can import from, made of the pip of this environment."""
    import pip

    path = tmp_path_factory.mktemp("pip") / "pip-0-py3-none-any.whl"
    package = Path(pip.__file__).parent
    with ZipFile(path, "w") as archive:
        for file in package.rglob("*"):
            if "__pycache__" not in file.parts and file.is_file():
                archive.write(file, file.relative_to(package.parent))
    return path


class Line:
    """A bundle and the folder that it is installed below."""

    def __init__(self, folder: Path, pip_wheel: Path) -> None:
        self.folder, self.pip_wheel, self.root = folder, pip_wheel, folder / "root"
        self.root.mkdir()
        self.release = folder / "os-release"
        name, number = str(SYSTEM).split("-")
        self.release.write_text(f'ID={name}\nVERSION_ID="{number}"\n')
        self.base = self.root / "opt" / "weldgate"

    def bundle(self, version: str, start: str = "") -> Path:
        made = self.folder / f"bundle-{version}"
        (made / "wheels").mkdir(parents=True)
        (made / "tools").mkdir()
        shutil.copy(self.pip_wheel, made / "tools")
        bundle.describe(made, version, {PYTHON: [make_wheel(made / "wheels", version, start)]})
        (made / "libraries.txt").write_text("")
        (made / "SIZE_MB").write_text("1\n")
        self.seal(made)
        return made

    def seal(self, made: Path) -> None:
        (made / "SHA256SUMS").unlink(missing_ok=True)
        found = sorted(path for path in made.rglob("*") if path.is_file())
        sums = [
            f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(made)}\n" for path in found
        ]
        (made / "SHA256SUMS").write_text("".join(sums))

    def environment(self) -> dict[str, str]:
        own = {"WELDGATE_ROOT": str(self.root), "WELDGATE_OS_RELEASE": str(self.release)}
        return {name: text for name, text in os.environ.items() if not name.startswith("PYTHON")} | own

    def run(self, script: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
        command = ["sh", str(script), *arguments]
        return subprocess.run(
            command, env=self.environment(), capture_output=True, text=True, timeout=300, check=False
        )

    def state(self) -> dict[str, str]:
        """All files and links below the folder, with what is in them."""
        return {
            path.relative_to(self.root).as_posix(): str(path.readlink())
            if path.is_symlink()
            else hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(self.root.rglob("*"))
            if (path.is_symlink() or path.is_file())
            and "__pycache__" not in path.parts
            and path.name != "weldgate-install.lock"
        }

    def active(self) -> str:
        command = [self.root / "usr/local/bin/weldgate"]
        return subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout.strip()


@pytest.fixture
def line(tmp_path: Path, pip_wheel: Path) -> Line:
    return Line(tmp_path, pip_wheel)


def test_install_upgrade_roll_back_and_remove(line: Line) -> None:
    first, second = line.bundle("1.0.0"), line.bundle("2.0.0")
    done = line.run(first / "install.sh")
    assert done.returncode == 0, done.stderr
    assert line.active() == "weldgate 1.0.0"
    settings = line.root / "etc/weldgate/station.toml"
    network = line.base / "current/networks/weldgate.onnx"
    assert network.is_file()
    assert str(network) in settings.read_text()
    assert settings.stat().st_mode & 0o777 == 0o640
    assert (line.root / "var/lib/weldgate/records").stat().st_mode & 0o777 == 0o750
    settings.write_text(settings.read_text() + "# of this line\n")
    (line.root / "var/lib/weldgate/records/one.json").write_text("{}")

    before = line.state()
    again = line.run(first / "install.sh")
    assert again.returncode == 0
    assert "already installed; nothing was changed" in again.stdout
    assert line.state() == before

    assert line.run(second / "install.sh").returncode == 0
    assert line.active() == "weldgate 2.0.0"
    assert settings.read_text().endswith("# of this line\n")
    assert line.run(line.root / "usr/local/sbin/weldgate-rollback").returncode == 0
    assert line.active() == "weldgate 1.0.0"
    assert line.run(line.root / "usr/local/sbin/weldgate-rollback").returncode == 0
    assert line.active() == "weldgate 2.0.0"

    assert line.run(line.root / "usr/local/sbin/weldgate-uninstall").returncode == 0
    left = {"etc/weldgate/station.toml", "var/lib/weldgate/records/one.json"}
    assert set(line.state()) == left


def refused(line: Line, made: Path, words: str, *arguments: str) -> None:
    before = line.state()
    done = line.run(made / "install.sh", *arguments)
    assert done.returncode == 2, done.stdout
    assert len(done.stderr.splitlines()) == 1, done.stderr
    assert words in done.stderr
    assert "Nothing was changed." in done.stderr
    assert line.state() == before


@pytest.mark.parametrize("system", ["debian-11", "ubuntu-22.04", "fedora-42"])
def test_another_system_is_refused(line: Line, system: str) -> None:
    name, number = system.split("-")
    line.release.write_text(f"ID={name}\nVERSION_ID={number}\n")
    refused(line, line.bundle("1.0.0"), f"{system} is not supported")


def test_a_damaged_bundle_is_refused(line: Line) -> None:
    made = line.bundle("1.0.0")
    (wheel,) = (made / "wheels").iterdir()
    wheel.write_bytes(wheel.read_bytes()[:-1] + b"x")
    refused(line, made, f"the bundle is damaged: wheels/{wheel.name}")
    wheel.unlink()
    refused(line, made, "the bundle is damaged")


def test_a_full_disk_and_missing_libraries_are_refused(line: Line) -> None:
    made = line.bundle("1.0.0")
    (made / "SIZE_MB").write_text("999999999\n")
    line.seal(made)
    refused(line, made, "999999999 MB are needed")
    (made / "libraries.txt").write_text("libnowhere.so.7 libnowhere7\n")
    line.seal(made)
    refused(line, made, "install the packages libnowhere7")


@pytest.mark.skipif(shutil.which("openssl") is None, reason="needs openssl")
def test_only_a_bundle_of_the_right_key_passes(line: Line, tmp_path: Path) -> None:
    for name in ("own", "other"):
        subprocess.run(
            ["openssl", "genpkey", "-algorithm", "ed25519", "-out", tmp_path / name], check=True, timeout=60
        )
        command = ["openssl", "pkey", "-in", tmp_path / name, "-pubout", "-out", tmp_path / f"{name}.pub"]
        subprocess.run(command, check=True, timeout=60)
    made = line.bundle("1.0.0")
    refused(line, made, "the bundle is not signed", "--key", str(tmp_path / "own.pub"))
    bundle.sign(made, tmp_path / "own")
    refused(line, made, "does not belong to", "--key", str(tmp_path / "other.pub"))
    assert line.run(made / "install.sh", "--key", str(tmp_path / "own.pub")).returncode == 0
    with pytest.raises(BundleError, match="cannot sign with this key"):
        bundle.sign(made, tmp_path / "own.pub")


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root becomes another user")
def test_a_normal_user_is_refused(line: Line) -> None:
    script = shutil.copy(line.bundle("1.0.0") / "install.sh", "/var/tmp/weldgate-install-test.sh")
    try:
        done = subprocess.run(
            ["sh", script],
            user=65534,
            group=65534,
            cwd="/",
            env={"PATH": os.environ["PATH"]},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )
    finally:
        Path(script).unlink()
    assert done.returncode == 2
    assert done.stderr.startswith("install.sh: root is needed")


def test_a_new_version_that_does_not_work_leaves_the_old_one(line: Line) -> None:
    assert line.run(line.bundle("1.0.0") / "install.sh").returncode == 0
    before = line.state()
    broken = line.run(line.bundle("2.0.0", start="raise SystemExit('broken')\n") / "install.sh")
    assert broken.returncode == 2
    assert "does not start" in broken.stderr
    assert line.state() == before
    settings = line.root / "etc/weldgate/station.toml"
    settings.write_text("# refuse-3.0.0\n")
    before = line.state()
    unread = line.run(line.bundle("3.0.0") / "install.sh")
    assert unread.returncode == 2
    assert f"cannot use {settings}" in unread.stderr
    assert line.state() == before
    assert line.active() == "weldgate 1.0.0"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_an_interrupted_installation_leaves_the_old_version(line: Line, number: int) -> None:
    assert line.run(line.bundle("1.0.0") / "install.sh").returncode == 0
    before = line.state()
    second = line.bundle("2.0.0")
    with subprocess.Popen(
        ["sh", second / "install.sh"],
        env=line.environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        start_new_session=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith(b"installing weldgate 2.0.0")
        os.killpg(process.pid, number)
        process.wait(timeout=60)
    assert line.active() == "weldgate 1.0.0"
    if number == signal.SIGTERM:
        assert line.state() == before
    assert line.run(second / "install.sh").returncode == 0
    assert line.active() == "weldgate 2.0.0"


def test_a_running_station_is_not_changed_unless_asked(line: Line) -> None:
    assert line.run(line.bundle("1.0.0") / "install.sh").returncode == 0
    second = line.bundle("2.0.0")
    python = next(line.base.glob("1.0.0-*")) / "bin" / "python"
    with subprocess.Popen(
        [python, "-c", "import time; print(1, flush=True); time.sleep(600)"], stdout=subprocess.PIPE
    ) as station:
        try:
            assert station.stdout is not None
            station.stdout.readline()
            refused(line, second, "the station is running")
            assert line.run(line.root / "usr/local/sbin/weldgate-uninstall").returncode == 2
        finally:
            station.kill()
    assert line.run(second / "install.sh").returncode == 0

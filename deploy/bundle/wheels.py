"""Gets the wheels of a bundle: its own from the checkout, others at the versions of constraints.txt."""

import hashlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from pathlib import Path
from zipfile import BadZipFile, ZipFile

from deploy.bundle.systems import System, platforms

ROOMS = ("station", "synth", "models", "deploy")
EXTRAS = ("tls", "pdf")
"""Optional parts that a line PC uses; renderer and training are none of them."""


class BundleError(Exception):
    """A bundle cannot be built: what happened, where, what to do."""


def own_wheel(root: Path, out: Path) -> Path:
    """Build the wheel of a checkout in a copy of it and return its path. Raises BundleError."""
    if not (root / "pyproject.toml").is_file() or not (root / "constraints.txt").is_file():
        raise BundleError(f"{root}: not a checkout of weldgate. Run this in a checkout.")
    with tempfile.TemporaryDirectory(prefix="weldgate-wheel-") as folder:
        source = Path(folder)
        for name in ROOMS:
            shutil.copytree(root / name, source / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("pyproject.toml", "README.md", "LICENSE"):
            shutil.copy(root / name, source)
        _pip("wheel", "--no-deps", "--no-build-isolation", "-w", str(out), str(source))
    (wheel,) = out.glob("weldgate-*.whl")
    return wheel


def fetch(root: Path, system: System, out: Path) -> list[Path]:
    """Download all packages that weldgate needs on a system and return their wheels. Raises BundleError."""
    with tempfile.TemporaryDirectory(prefix="weldgate-fetch-") as folder:
        options = [part for tag in platforms(system) for part in ("--platform", tag)]
        target = ("--python-version", system.python, "--implementation", "cp", *options)
        chosen = ("-c", str(root / "constraints.txt"), "--only-binary", ":all:", "-d", folder)
        _pip("download", *target, *chosen, *requirements(root))
        return [Path(shutil.move(path, out / path.name)) for path in sorted(Path(folder).glob("*.whl"))]


def fetch_pip(out: Path) -> None:
    """Download pip itself: the system's Python may have none. Raises BundleError."""
    _pip("download", "--no-deps", "--only-binary", ":all:", "-d", str(out), "pip")


def requirements(root: Path) -> list[str]:
    """Return what weldgate requires on a line PC."""
    project = tomllib.loads((root / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"]
    return [*project["dependencies"], *(item for extra in EXTRAS for item in extras[extra])]


def pinned(wheels: Iterable[Path]) -> str:
    """Return requirements with version and SHA-256 of each wheel, as `pip --require-hashes` needs them."""
    lines = []
    for wheel in sorted(wheels):
        name, version = wheel.name.split("-")[:2]
        lines.append(f"{name}=={version} --hash=sha256:{sha256(wheel)}")
    return "\n".join(lines) + "\n"


def unpacked_mb(wheels: Iterable[Path]) -> int:
    """Return the size in MB of the files of some wheels once they are installed. Raises BundleError."""
    size = 0
    for wheel in wheels:
        try:
            with ZipFile(wheel) as archive:
                size += sum(item.file_size for item in archive.infolist())
        except BadZipFile:
            raise BundleError(f"{wheel}: not a wheel. Delete it and build the bundle again.") from None
    return -(-size // 1_000_000)


def sha256(path: Path) -> str:
    """Return the SHA-256 of a file in hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _pip(*arguments: str) -> None:
    command: Sequence[str] = (sys.executable, "-m", "pip", "--disable-pip-version-check", "-q", *arguments)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        lines = [
            line for line in done.stderr.splitlines() if line.startswith("ERROR")
        ] or done.stderr.splitlines()
        raise BundleError(f"pip {arguments[0]} failed: {lines[-1] if lines else 'no message'}")

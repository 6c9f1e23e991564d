"""Builds the offline bundle: `python -m deploy.bundle --out build/bundle`."""

import argparse
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from deploy.bundle.debian import build_package
from deploy.bundle.systems import LIBRARIES, SYSTEMS
from deploy.bundle.wheels import BundleError, fetch, fetch_pip, own_wheel, pinned, sha256, unpacked_mb

ROOT = Path(__file__).resolve().parent.parent.parent
FILES = Path(__file__).resolve().parent / "files"
SPARE_MB = 300
"""Free space besides the files themselves: compiled modules, pip's temporary files, the first records."""


def main(argv: Sequence[str] | None = None) -> int:
    """Build a bundle; 0 if it is whole, 2 if it cannot be built."""
    parser = argparse.ArgumentParser(
        prog="python -m deploy.bundle", description="Build the offline bundle of the line PC."
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=ROOT / "build" / "bundle",
        metavar="DIR",
        help="write the bundle into this new folder (default: %(default)s)",
    )
    parser.add_argument(
        "--system",
        action="append",
        choices=sorted(SYSTEMS),
        help="include the packages of this system; can be given again (default: all)",
    )
    parser.add_argument(
        "--key", type=Path, metavar="FILE", help="sign the bundle with this Ed25519 private key (PEM)"
    )
    parser.add_argument("--deb", action="store_true", help="build a Debian package of the bundle next to it")
    arguments = parser.parse_args(argv)
    try:
        if arguments.out.exists():
            raise BundleError(
                f"{arguments.out}: exists already. Delete it or name another folder with --out."
            )
        version = build(arguments.out, arguments.system or sorted(SYSTEMS), arguments.key)
        if arguments.deb:
            print(build_package(arguments.out, version))
    except (BundleError, OSError) as error:
        print(f"deploy.bundle: {error}", file=sys.stderr)
        return 2
    print(arguments.out)
    return 0


def build(out: Path, systems: Sequence[str], key: Path | None) -> str:
    """Build a bundle in a new folder and return the version of weldgate. Raises BundleError."""
    part = out.with_name(f"{out.name}.part")
    shutil.rmtree(part, ignore_errors=True)
    wheels, tools = part / "wheels", part / "tools"
    wheels.mkdir(parents=True)
    tools.mkdir()
    own = own_wheel(ROOT, wheels)
    fetch_pip(tools)
    needed = {SYSTEMS[name].python: [own, *fetch(ROOT, SYSTEMS[name], wheels)] for name in systems}
    version = own.name.split("-")[1]
    describe(part, version, needed)
    sign(part, key)
    part.rename(out)
    return version


def describe(folder: Path, version: str, needed: Mapping[str, Sequence[Path]]) -> None:
    """Write scripts, requirements by version of Python, and checksums into a bundle that has its wheels."""
    files = folder / "files"
    shutil.copytree(FILES, files)
    (files / "install.sh").rename(folder / "install.sh")
    for python, wheels in needed.items():
        (folder / f"requirements-{python}.txt").write_text(pinned(wheels))
    size = max(unpacked_mb(wheels) for wheels in needed.values()) + SPARE_MB
    (folder / "SIZE_MB").write_text(f"{size}\n")
    (folder / "VERSION").write_text(f"{version}\n")
    (folder / "libraries.txt").write_text("".join(f"{library} {package}\n" for library, package in LIBRARIES))
    found = sorted(path for path in folder.rglob("*") if path.is_file())
    sums = "".join(f"{sha256(path)}  {path.relative_to(folder).as_posix()}\n" for path in found)
    (folder / "SHA256SUMS").write_text(sums)


def sign(folder: Path, key: Path | None) -> None:
    """Sign the checksums of a bundle with an Ed25519 key, if there is one. Raises BundleError."""
    if key is None:
        return
    command = ["openssl", "pkeyutl", "-sign", "-inkey", str(key.resolve()), "-rawin"]
    command += ["-in", "SHA256SUMS", "-out", "SHA256SUMS.sig"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise BundleError(f"{key}: cannot sign with this key. Make one: openssl genpkey -algorithm ed25519.")


if __name__ == "__main__":
    sys.exit(main())

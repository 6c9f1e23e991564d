"""Wraps a bundle as a Debian package that names the system libraries and runs install.sh and uninstall.sh."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from deploy.bundle.systems import LIBRARIES
from deploy.bundle.wheels import BundleError

PLACE = "usr/lib/weldgate/bundle"
CONTROL = """Package: weldgate
Version: {version}
Architecture: amd64
Maintainer: weldgate <weldgate@localhost>
Section: misc
Priority: optional
Installed-Size: {size_kb}
Depends: python3 (>= 3.11), python3 (<< 3.14), {libraries}
Recommends: xinit, xserver-xorg
Description: inline inspection of circular laser welds
 Engine and window of the inspection station. The station is installed in
 /opt/weldgate; records and settings are kept when the package is removed.
"""
POSTINST = f"""#!/bin/sh
set -e
if [ "$1" = configure ]; then sh /{PLACE}/install.sh --restart; fi
"""
PRERM = """#!/bin/sh
set -e
if [ "$1" = remove ] && [ -e /opt/weldgate/current/setup/uninstall.sh ]; then
    sh /opt/weldgate/current/setup/uninstall.sh
fi
"""


def build_package(bundle: Path, version: str) -> Path:
    """Build weldgate_VERSION_amd64.deb next to a bundle and return its path. Raises BundleError."""
    target = bundle.parent / f"weldgate_{version}_amd64.deb"
    part = target.with_suffix(".part")
    with tempfile.TemporaryDirectory(prefix="weldgate-deb-", dir=bundle.parent) as folder:
        tree = Path(folder)
        tree.chmod(0o755)
        shutil.copytree(bundle, tree / PLACE, copy_function=os.link)
        size_kb = sum(path.stat().st_size for path in bundle.rglob("*") if path.is_file()) // 1024
        (tree / "DEBIAN").mkdir()
        # libglib2.0-0 has another name on newer systems, which provide the old one
        libraries = ", ".join(package for _, package in LIBRARIES)
        control = CONTROL.format(version=version, size_kb=size_kb, libraries=libraries)
        (tree / "DEBIAN" / "control").write_text(control)
        for name, text in (("postinst", POSTINST), ("prerm", PRERM)):
            (tree / "DEBIAN" / name).write_text(text)
            (tree / "DEBIAN" / name).chmod(0o755)
        # wheels are compressed already
        command = ["dpkg-deb", "--root-owner-group", "-Znone", "--build", str(tree), str(part)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        part.unlink(missing_ok=True)
        raise BundleError(f"dpkg-deb failed: {done.stderr.strip().splitlines()[-1]}")
    part.replace(target)
    return target

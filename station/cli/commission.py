"""`weldgate commission`: makes what an installation needs before the first person can log in."""

import os
from pathlib import Path

from station.journal.commissioning import make_code
from station.settings.file import load
from station.settings.keys import keys_folder


def commission(settings: Path) -> int:
    """Make a commissioning code and print it; return the exit code. Raises WeldgateError, OSError."""
    archive = load(settings).archive.folder
    keys = keys_folder(settings)
    code = make_code(keys)
    if archive.exists():
        _give(keys, archive.stat())
    print(f"commissioning code: {code}")
    print("Enter it in the window (Setup, Login) with a new name and PIN: it makes one administrator.")
    print(f"The keys of this installation are in {keys}. Back the folder up, and keep it secret.")
    return 0


def _give(keys: Path, owner: os.stat_result) -> None:
    """Give the keys to the account that owns the archive, which is the engine's, where root made them."""
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        for path in (keys, *keys.iterdir()):
            os.chown(path, owner.st_uid, owner.st_gid, follow_symlinks=False)

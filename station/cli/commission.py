"""`weldgate commission`: makes what an installation needs before the first person can log in."""

import os
import stat
from pathlib import Path

from station.errors import LoginError
from station.journal.commissioning import make_code
from station.settings.file import load
from station.settings.keys import keys_folder


def commission(settings: Path) -> int:
    """Make a commissioning code and print it; return the exit code. Raises WeldgateError, OSError."""
    archive = load(settings).archive.folder
    keys = keys_folder(settings)
    if _is_root() and keys.is_symlink():
        raise LoginError(
            f"{keys}: is a link, through which root gives no files away; run the command under the account "
            "of the engine, or replace the link by the folder"
        )
    code = make_code(keys)
    _give(keys, (archive if archive.exists() else settings).stat())
    print(f"commissioning code: {code}")
    print("Enter it in the window (Setup, Login) with a new name and PIN: it makes one administrator.")
    print(f"The keys of this installation are in {keys}. Back the folder up, and keep it secret.")
    return 0


def _is_root() -> bool:
    return hasattr(os, "geteuid") and os.geteuid() == 0


def _give(keys: Path, owner: os.stat_result) -> None:
    """Give the keys to the engine's account, which owns the archive or the settings, where root made them.

    That account may own the folder around and exchange what lies there: no link is followed, and a file with
    a second name elsewhere is left alone.
    """
    if not _is_root():
        return
    folder = os.open(keys, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        os.fchown(folder, owner.st_uid, owner.st_gid)
        with os.scandir(folder) as entries:
            names = [entry.name for entry in entries]
        for name in names:
            file = os.open(name, os.O_PATH | os.O_NOFOLLOW, dir_fd=folder)
            try:
                status = os.fstat(file)
                if stat.S_ISREG(status.st_mode) and status.st_nlink == 1:
                    os.chown(f"/proc/self/fd/{file}", owner.st_uid, owner.st_gid)
            finally:
                os.close(file)
    finally:
        os.close(folder)

"""Files that other accounts may not use: keys and codes of an installation, locks, databases."""

import os
import stat
from contextlib import suppress
from pathlib import Path

from station.files.durable import sync_folder
from station.files.regular import read_regular

FOLDER_MODE, FILE_MODE = 0o700, 0o600
OTHERS = 0o077
"""Bits of a mode that admit other accounts."""
MAX_BYTES = 65_536
"""Maximum length of such a file."""


def close_to(path: Path, bits: int) -> None:
    """Take these bits from the mode of a file; one of another account, which must close it, stays."""
    with suppress(OSError):
        mode = stat.S_IMODE(path.stat().st_mode)
        if mode & bits:
            path.chmod(mode & ~bits)


def write_private(path: Path, data: bytes, *, replace: bool = True) -> None:
    """Write a file durably and whole; its folder is made if it is missing. Raises OSError.

    Without `replace`, an existing file stays and FileExistsError is raised.
    """
    if not path.parent.exists():
        path.parent.mkdir(mode=FOLDER_MODE)
    part = path.with_name(f"{path.name}.{os.getpid()}.part")
    with suppress(FileNotFoundError):
        part.unlink()
    handle = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, FILE_MODE)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        if replace:
            part.replace(path)
        else:
            os.link(part, path)
        sync_folder(path.parent)
    finally:
        part.unlink(missing_ok=True)


def read_private(path: Path) -> bytes:
    """Return the content of a file that nobody else may read or write.

    Raises FileNotFoundError, or OSError if it cannot be read or others may use it or its folder.
    """
    for place, what in ((path.parent, "write in its folder"), (path, "read or write it")):
        status = place.stat()
        bits = OTHERS if place is path else stat.S_IWGRP | stat.S_IWOTH
        if status.st_mode & bits:
            raise PermissionError(1, f"other accounts may {what}; run 'chmod go-rwx' on it", str(place))
        mine = not hasattr(os, "geteuid") or os.geteuid() == 0 or status.st_uid in (0, os.geteuid())
        if not mine:
            raise PermissionError(1, "belongs to another account", str(place))
    return read_regular(path, MAX_BYTES)

"""Files that are whole or not there."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PART = ".new.part"
"""Suffix of a file while it is written."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a free name next to `path`; the file written under it takes the place of `path` at the end.

    After an error nothing is left of it, and `path` stays as it was. Raises OSError.
    """
    part = path.with_name(path.name + PART)
    part.unlink(missing_ok=True)
    try:
        yield part
        part.replace(path)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def write_whole(path: Path, data: bytes, *, durable: bool = False) -> None:
    """Write a file so that never half of it is seen under its name. Raises OSError.

    With `durable` the content is on disk when this returns; `sync_folder` does the same for the name.
    """
    with replacing(path) as part, part.open("wb") as file:
        file.write(data)
        if durable:
            file.flush()
            os.fsync(file.fileno())


def stage(path: Path, data: bytes) -> Path:
    """Write durably under a temporary name, ready to be renamed to `path`; return it. Raises OSError."""
    part = path.with_name(path.name + PART)
    with part.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    return part


def sync_folder(folder: Path) -> None:
    """Make the names in a folder durable. Raises OSError."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

"""Writes files atomically: a file has its whole content, or it does not exist."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PART = ".new.part"
"""Suffix of a file while it is being written."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path next to `path`; the file written there replaces `path` at the end.

    After an error the temporary file is deleted, and `path` is unchanged. Raises OSError.
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
    """Write a file atomically. Raises OSError.

    With `durable`, the content is on disk when this returns; `sync_folder` does the same for the name.
    """
    with replacing(path) as part, part.open("wb") as file:
        file.write(data)
        if durable:
            file.flush()
            os.fsync(file.fileno())


def stage(path: Path, data: bytes) -> Path:
    """Write a file durably under a temporary name and return its path, ready to be renamed to `path`.

    Raises OSError.
    """
    part = path.with_name(path.name + PART)
    with part.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    return part


def sync_folder(folder: Path) -> None:
    """Write the file names of a folder to disk, so that they survive a power failure. Raises OSError."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

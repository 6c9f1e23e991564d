"""Writes files atomically: a file has its whole content, or it does not exist."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from station.files.destination import find_destination

PART = ".new.part"
"""Suffix of a file while it is being written."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a temporary path; the file written there takes the place of `path` at the end.

    A regular file is replaced with its mode and owner kept, where links lead. Devices, FIFOs and open
    descriptors are written to. After an error the temporary file is deleted, and `path` is unchanged. Raises
    OSError.
    """
    destination = find_destination(path)
    destination.check()
    if not destination.is_replaceable:
        with tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
            part = Path(folder) / "output.part"
            yield part
            destination.fill(part)
        return
    part = destination.path.with_name(destination.path.name + PART)
    part.unlink(missing_ok=True)
    try:
        yield part
        destination.give_mode_and_owner(part)
        part.replace(destination.path)
    except BaseException:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise


def write_whole(path: Path, data: bytes, *, durable: bool = False) -> None:
    """Write a file atomically, like `replacing`. Raises OSError.

    With `durable`, the content is on disk when this returns; `sync_folder` does the same for the name.
    """
    with replacing(path) as part, part.open("wb") as file:
        file.write(data)
        if durable:
            file.flush()
            os.fsync(file.fileno())


def stage(path: Path, data: bytes) -> tuple[Path, Path]:
    """Write a file durably under a temporary name, ready to be renamed to `path`.

    Return the temporary path and the path that it has to replace, where links lead. Raises OSError.
    """
    destination = find_destination(path)
    destination.check()
    part = destination.path.with_name(destination.path.name + PART)
    with part.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    destination.give_mode_and_owner(part)
    return part, destination.path


def sync_folder(folder: Path) -> None:
    """Write the file names of a folder to disk, so that they survive a power failure. Raises OSError."""
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

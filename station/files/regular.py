"""Reads regular files alone: a device, a FIFO or a file without end is refused instead of read."""

import os
import stat
from pathlib import Path


def read_regular(path: Path, max_bytes: int) -> bytes:
    """Return the content of a regular file of at most this size. Raises OSError."""
    try:
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except ValueError:  # a NUL in the name
        raise OSError(22, "not a file name", str(path)) from None
    with os.fdopen(handle, "rb") as file:
        status = os.fstat(handle)
        if not stat.S_ISREG(status.st_mode):
            raise OSError(22, "not a regular file", str(path))
        if status.st_size > max_bytes:
            raise OSError(27, f"larger than {max_bytes // 1_000_000} MB", str(path))
        return file.read(max_bytes + 1)

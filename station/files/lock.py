"""Locks between processes, through filelock; the only file that imports it."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from filelock import BaseFileLock


def hold(path: Path) -> "BaseFileLock":
    """Take the lock of this file until `release()`; the system frees it if this process dies.

    Raises BlockingIOError at once if the lock is held already, OSError if there can be no such file or lock.
    """
    from filelock import FileLock, Timeout  # the window starts without it

    # A file that only marks the lock by being there would outlive a killed holder: no fallback to it.
    lock = FileLock(path, blocking=False, thread_local=False, fallback_to_soft=False)
    path.parent.stat()  # an absent folder is an error; filelock would create it
    try:
        lock.acquire()
    except Timeout:
        raise BlockingIOError(f"{path}: held by another process") from None
    return lock

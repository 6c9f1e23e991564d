"""Locks between processes; the only file that imports filelock."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from filelock import BaseFileLock


def hold(path: Path) -> "BaseFileLock":
    """Take the lock of this file until `release()`; the operating system frees it if this process dies.

    Does not wait. Raises BlockingIOError if the lock is already held, OSError if the file cannot be locked.
    """
    from filelock import FileLock, Timeout  # imported here so that the window starts faster

    # No soft lock: a file that marks the lock by its existence would outlive a killed holder.
    lock = FileLock(path, blocking=False, thread_local=False, fallback_to_soft=False)
    path.parent.stat()  # a missing folder is an error; filelock would create it
    try:
        lock.acquire()
    except Timeout:
        raise BlockingIOError(f"{path}: held by another process") from None
    return lock

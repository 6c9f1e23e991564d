"""Locks between processes; the only file that imports filelock.

Who may read a lock file may hold the lock, so only accounts that may write it can read it.
"""

import os
import stat
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from station.files.private import close_to

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
    _close_to_others(path)
    return lock


@contextmanager
def turn(path: Path, patience_s: float) -> Iterator[None]:
    """Wait for the turn among the processes and threads that use this lock file, and hold it.

    The kernel wakes those who wait, so that each gets its turn; who asks from time to time may never find the
    lock free. Raises BlockingIOError after `patience_s`, OSError if the file cannot be locked.
    """
    handle = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0), 0o660)
    _close_to_others(path)
    waiting = _Waiting(handle)
    try:
        if not waiting.lock(patience_s):
            raise BlockingIOError(11, "another process is writing", str(path))
        yield
    finally:
        waiting.close()


def _close_to_others(path: Path) -> None:
    """Take the right to read a lock file, which is enough to hold its lock, from who may not write it."""
    with suppress(OSError):
        close_to(path, 0o007 if path.stat().st_mode & stat.S_IWGRP else 0o077)


class _Waiting:
    """A handle that is locked, or closed as soon as it can be."""

    def __init__(self, handle: int) -> None:
        self._handle, self._given_up = handle, False
        self._decision = threading.Lock()
        self._done = threading.Event()
        self._thread: threading.Thread | None = None

    def lock(self, patience_s: float) -> bool:
        """Return whether the handle was locked in time. Raises OSError."""
        until_s = time.monotonic() + patience_s
        if _try_lock(self._handle):
            return True
        if os.name != "posix":
            while time.monotonic() < until_s:
                time.sleep(0.005)
                if _try_lock(self._handle):
                    return True
            return False
        self._thread = threading.Thread(target=self._wait, daemon=True)
        self._thread.start()
        return self._done.wait(patience_s)

    def close(self) -> None:
        """Give the lock free; if it is still waited for, as soon as it is there."""
        with self._decision:
            if self._thread is not None and not self._done.is_set():
                self._given_up = True
                return
        os.close(self._handle)

    def _wait(self) -> None:
        import fcntl

        with suppress(OSError):
            fcntl.flock(self._handle, fcntl.LOCK_EX)
        with self._decision:
            self._done.set()
            if self._given_up:
                os.close(self._handle)


def _try_lock(handle: int) -> bool:
    if os.name == "posix":
        import fcntl

        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True
    import msvcrt

    try:
        msvcrt.locking(handle, msvcrt.LK_NBLCK, 1)  # type: ignore[attr-defined]
    except OSError:
        return False
    return True

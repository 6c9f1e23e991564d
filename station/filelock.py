"""A lock on a folder, held as long as the process lives; freed by the system if it dies."""

import sys
from io import BufferedRandom
from pathlib import Path


class FolderLock:
    """Raises BlockingIOError if another process holds the folder."""

    def __init__(self, folder: Path) -> None:
        self._file: BufferedRandom = (folder / "engine.lock").open("a+b")
        try:
            _lock(self._file)
        except OSError:
            self._file.close()
            raise

    def close(self) -> None:
        """Let go."""
        self._file.close()


if sys.platform == "win32":
    import msvcrt

    def _lock(file: BufferedRandom) -> None:
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(file: BufferedRandom) -> None:
        fcntl.flock(file.fileno(), fcntl.LOCK_EX | fcntl.LOCK_NB)

"""A lock between processes, freed by the system if the one that holds it dies."""

import sys
from io import BufferedRandom
from pathlib import Path


class FileLock:
    """Held from the start until `close`. Raises BlockingIOError if another process holds it, else OSError if there can be no such file."""

    def __init__(self, path: Path) -> None:
        self._file: BufferedRandom = path.open("a+b")
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

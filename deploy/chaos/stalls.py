"""How long the threads of this process had to wait for a processor: what the machine, not the code, cost.

Waiting for a lock, a reply or the interpreter does not count, so a fault of the station cannot hide in it.
"""

from contextlib import suppress
from pathlib import Path

TASKS = Path("/proc/self/task")
"""Folder with a folder for each thread; on Linux alone."""
WAITED = 1
"""Position of the time in a thread's `schedstat`, in nanoseconds: ready to run, but not running."""


class Stalls:
    """Time that the threads of this process waited for a processor."""

    def __init__(self) -> None:
        self._before = _waited_ns()

    def since_last_s(self) -> float:
        """Return the seconds since the last call, over all threads; 0 where the system does not say."""
        now = _waited_ns()
        waited_ns = sum(total - self._before.get(thread, 0) for thread, total in now.items())
        self._before = now
        return waited_ns / 1e9


def _waited_ns() -> dict[str, int]:
    found: dict[str, int] = {}
    with suppress(OSError):
        for thread in TASKS.iterdir():
            with suppress(OSError, IndexError, ValueError):  # it has just ended
                found[thread.name] = int((thread / "schedstat").read_text().split()[WAITED])
    return found

"""Signs of life of the engine's threads; one that is overdue hangs."""

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

IDLE_S = 120.0
"""Time within which the cycle, settings changes and requests must be done with whatever they do."""
WIRE_S = 30.0
"""Time within which one step of the PLC connection must be done."""
DISK_S = 120.0
"""Time within which an entry of the journal must be written."""
PRUNING_S = 3600.0
"""Time within which a pruning of the archive must be done."""


class CheckIns:
    """The next sign of life that is due from each thread. All threads may use it."""

    def __init__(self, now_s: Callable[[], float] = time.monotonic) -> None:
        """`now_s` returns the monotonic time."""
        self._now_s = now_s
        self._due_s: dict[str, float] = {}
        self._lock = threading.Lock()

    def expect(self, name: str, within_s: float) -> None:
        """Take note that a thread is alive; its next sign of life is due within this time."""
        with self._lock:
            self._due_s[name] = self._now_s() + within_s

    def rest(self, name: str) -> None:
        """Take note that a thread waits for work: no sign of life is due."""
        with self._lock:
            self._due_s.pop(name, None)

    @contextmanager
    def working(self, name: str, within_s: float) -> Iterator[None]:
        """Expect that a piece of work is done within this time."""
        self.expect(name, within_s)
        try:
            yield
        finally:
            self.rest(name)

    def overdue(self) -> dict[str, float]:
        """Return the threads that hang, with the seconds since their sign of life was due."""
        now_s = self._now_s()
        with self._lock:
            return {name: now_s - due_s for name, due_s in self._due_s.items() if now_s > due_s}

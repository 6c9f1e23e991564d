"""Counts tries of PINs before they are checked, on a clock that nobody can set; pure."""

import threading
from collections import deque
from collections.abc import Callable, Iterable

from station.errors import LoginError

TRIES, LOCKED_S = 5, 60.0
"""Number of tries without success within a time that lock a name, and that time."""


class Tries:
    """Tries by name. May be used from several threads."""

    def __init__(self, clock: Callable[[], float], locked: Iterable[str] = ()) -> None:
        """`clock`: monotonic; `locked`: names that are locked at the start."""
        self._clock, self._lock = clock, threading.Lock()
        self._times: dict[str, deque[float]] = {
            name: deque([clock()] * TRIES, maxlen=TRIES) for name in locked
        }

    def begin(self, name: str, *, bucket: str | None = None) -> None:
        """Count a try. Raises LoginError if the name is locked; then nothing may be checked.

        `bucket`: name under which it is counted, if it is another one.
        """
        with self._lock:
            now_s = self._clock()
            times = self._times.setdefault(name if bucket is None else bucket, deque(maxlen=TRIES))
            quick = len(times) == TRIES and times[-1] - times[0] < LOCKED_S
            if quick and (left_s := LOCKED_S - (now_s - times[-1])) > 0:
                why = f"{name} is locked for another {left_s:.0f} s after {TRIES} wrong PINs"
                raise LoginError(why, locked_s=left_s)
            times.append(now_s)

    def succeeded(self, name: str) -> None:
        """Forget the tries of a name: the PIN was right."""
        with self._lock:
            self._times.pop(name, None)

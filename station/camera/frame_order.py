"""Decides whether a frame belongs to a trigger, by the camera's clock and the numbers of its frames; pure."""

from dataclasses import dataclass

CLOCK_ERROR = 1e-3
"""Highest relative difference between the rates of camera clock and host clock, which may be slewed."""
WRAP = 0xFFFF
"""Highest number of a frame in GigE Vision 1; the next one is 1."""
FIRST = (0, 1)
"""Possible numbers of the first frame after a start."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Latch:
    """One reading of the camera's clock, between two readings of the host's."""

    ticks: int
    """Value of the camera's clock."""
    before_s: float
    """Monotonic time of the host just before the reading."""
    after_s: float
    """Monotonic time of the host just after the reading."""
    ticks_per_s: float

    def between_s(self, stamp: int) -> tuple[float, float]:
        """Return the earliest and the latest host time at which the camera's clock can have read `stamp`."""
        offset_s = (stamp - self.ticks) / self.ticks_per_s
        error_s = abs(offset_s) * CLOCK_ERROR
        return self.before_s + offset_s - error_s, self.after_s + offset_s + error_s


class FrameOrder:
    """Follows the numbers of the frames, so that none is missed or taken for another."""

    def __init__(self) -> None:
        self._last: int | None = None
        self._skipped = False
        self.unrequested = 0
        """Number of frames, since the camera was opened, that no trigger had asked for."""

    def restart(self) -> None:
        """Begin to count again, as the camera does when it starts to grab."""
        self._last, self._skipped = None, False

    def skip(self) -> None:
        """Pass over a damaged frame, whose number may be damaged too: the next number is not checked."""
        self._skipped = True

    def drop(self, number: int) -> None:
        """Pass over a frame that no trigger had asked for."""
        self._last, self._skipped = number, False
        self.unrequested += 1

    def lost(self, number: int) -> str:
        """Take in the number of a frame; return what is wrong with it, or an empty text."""
        last, self._last = self._last, number
        skipped, self._skipped = self._skipped, False
        follow = FIRST if last is None else (last + 1, 1) if last == WRAP else (last + 1,)
        if skipped or number in follow:
            return ""
        if last is None:
            return f"the first frame has number {number}: earlier frames were lost"
        return f"frame {number} follows frame {last}: frames were lost or repeated"


def is_before(stamp: int, latch: Latch, trigger_s: float) -> bool:
    """Return whether the exposure at `stamp` may have begun before the trigger, accepted at `trigger_s`."""
    return latch.between_s(stamp)[0] < trigger_s


def is_impossible(stamp: int, latch: Latch, now_s: float) -> bool:
    """Return whether the exposure would lie in the future: then the camera's clock was set or restarted."""
    return latch.between_s(stamp)[0] > now_s

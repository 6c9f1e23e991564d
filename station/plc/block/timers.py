"""On-delay timers as controllers have them, for the block's transcription."""

from dataclasses import dataclass
from enum import StrEnum

ACCESS_S = 2e-6
"""Time that passes in a controller between two accesses to a timer."""


class TimerKind(StrEnum):
    """Kinds of on-delay timers, by when they are updated."""

    CALL = "call"
    """By the call alone: IEC 61131-3, table 46 (CODESYS, TwinCAT, OpenPLC, Control Expert)."""
    ACCESS = "access"
    """By the call and by every access to Q: S7-1200 and S7-1500."""


@dataclass
class Clock:
    """Clock of a controller, which also runs within a cycle."""

    now_s: float = 0.0

    def access(self) -> float:
        """Return the time of an access, a little later than that of the last one."""
        self.now_s += ACCESS_S
        return self.now_s


@dataclass
class CallTimer:
    """Q is TRUE once IN has been TRUE for PT; a call updates it."""

    Q: bool = False
    since_s: float | None = None

    def __call__(self, now_s: float, IN: bool, PT: float) -> None:  # noqa: N803 - the standard's names
        """Update the timer."""
        if not IN:
            self.since_s, self.Q = None, False
        else:
            self.since_s = now_s if self.since_s is None else self.since_s
            self.Q = now_s - self.since_s >= PT


class AccessTimer:
    """Q is TRUE once IN has been TRUE for PT; a call or an access to Q updates it; PT is read as IN rises."""

    def __init__(self, clock: Clock) -> None:
        self._clock, self._time_s = clock, 0.0
        self._since_s: float | None = None

    def __call__(self, _now_s: float, IN: bool, PT: float) -> None:  # noqa: N803 - the standard's names
        """Update the timer."""
        now_s = self._clock.access()
        if not IN:
            self._since_s = None
        elif self._since_s is None:
            self._since_s, self._time_s = now_s, PT

    @property
    def Q(self) -> bool:  # noqa: N802 - the standard's name
        """Output of the timer, now."""
        now_s = self._clock.access()
        return self._since_s is not None and now_s - self._since_s >= self._time_s


def timer(kind: TimerKind, clock: Clock) -> CallTimer | AccessTimer:
    """Return a timer of a kind that has not started."""
    return CallTimer() if kind is TimerKind.CALL else AccessTimer(clock)

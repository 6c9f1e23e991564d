"""Orders of operators to the cycle; the rights of the user were checked before."""

import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from station.engine.active_settings import PreparedSettings

MAX_WAITING = 1000
"""Number of orders that wait for a stalled cycle; the oldest are dropped first."""
SLICE_S = 0.1
"""Time between two checks whether waiting must end."""
HUNG_S = 30.0
"""Time within which the cycle must finish an order that it has taken."""


class Ticket:
    """Outcome of one order: it is taken and answered once by the cycle, or withdrawn before it was taken."""

    def __init__(self) -> None:
        self._lock, self._answered = threading.Lock(), threading.Event()
        self._taken = self._withdrawn = False
        self.refusal = ""
        """Reason of the refusal; empty if the order was carried out or is not answered yet."""

    def take(self) -> bool:
        """Claim the order for the cycle; return False if it was withdrawn."""
        with self._lock:
            self._taken = not self._withdrawn
            return self._taken

    def answer(self, refusal: str) -> None:
        """Report the outcome: the reason of a refusal, or empty if the order was carried out."""
        self.refusal = refusal
        self._answered.set()

    def wait(self, patience_s: float, stop: threading.Event) -> str | None:
        """Return the reason of a refusal, empty if carried out; None if it was withdrawn, not taken in time.

        `patience_s`: time within which it must be taken; `stop` ends all waiting.
        """
        waited_s = 0.0
        while not self._answered.wait(SLICE_S):
            waited_s += SLICE_S
            if waited_s < patience_s and not stop.is_set():
                continue
            with self._lock:
                if not self._taken:
                    self._withdrawn = True
                    return None
            if waited_s > patience_s + HUNG_S:
                return "the engine did not finish: check its log, and whether the change is active"
        return self.refusal


@dataclass(frozen=True, slots=True)
class TestImage:
    """Order to take an image of what is in the nest now and judge it, without the PLC."""

    master: str = ""
    """Serial of the master in the nest; empty if it is not a master."""
    __test__ = False


@dataclass(frozen=True, slots=True)
class Service:
    """Order to begin, renew or end service mode; it lapses unless it is renewed in time."""

    who: str
    bit: int = field(default=0, kw_only=True)
    """Bit of STATUS to set by hand; 0: none."""
    setup_images: bool = field(default=False, kw_only=True)
    """True if setup images are to be taken, one after the other."""
    exposure_us: float | None = field(default=None, kw_only=True)
    """Exposure of the setup images; None: that of the settings."""
    gain_db: float | None = field(default=None, kw_only=True)
    """Gain of the setup images; None: that of the settings."""
    ended: bool = field(default=False, kw_only=True)
    """True to end service mode."""


@dataclass(frozen=True, slots=True)
class Reload:
    """Order to read the settings file again, after it was edited by hand."""

    ticket: Ticket = field(default_factory=Ticket)


@dataclass(frozen=True, slots=True)
class UseSettings:
    """Order to make prepared settings active and to put their file in place."""

    prepared: PreparedSettings
    replace_file: Callable[[], None]
    """Puts the prepared file in place atomically. Raises SettingsError."""
    ticket: Ticket = field(default_factory=Ticket)


@dataclass(frozen=True, slots=True)
class ResetCounts:
    """Order to set the counters back to 0."""

    who: str


Order = TestImage | Service | Reload | UseSettings | ResetCounts
"""An order of an operator to the cycle."""


class OrderQueue:
    """Queue of orders between two threads, neither of which ever waits."""

    def __init__(self) -> None:
        self._waiting: deque[Order] = deque(maxlen=MAX_WAITING)

    def put(self, order: Order) -> None:
        """Put an order into the queue."""
        self._waiting.append(order)

    def take(self) -> list[Order]:
        """Take all orders out of the queue and return them, the oldest first."""
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

"""What the cycle is asked to do next to parts; the thread that answers windows has checked who asks."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

from station.engine.active_settings import Change

MAX_WAITING = 1000
"""Orders that a cycle which stands still is kept; the oldest are dropped first."""
SLICE_S = 0.1
HUNG_S = 30.0
"""Time that the cycle has to finish an order that it has taken."""


class Ticket:
    """Outcome of one order: taken and answered once by the cycle, or withdrawn before it was taken."""

    def __init__(self) -> None:
        self._lock, self._answered = threading.Lock(), threading.Event()
        self._taken = self._withdrawn = False
        self.refusal = ""
        """Why the order was refused; empty: it was carried out, or is not answered yet."""

    def take(self) -> bool:
        """Claim the order for the cycle. Return False if it was withdrawn."""
        with self._lock:
            self._taken = not self._withdrawn
            return self._taken

    def answer(self, refusal: str) -> None:
        """Say how it went; empty: the order was carried out."""
        self.refusal = refusal
        self._answered.set()

    def wait(self, patience_s: float, stop: threading.Event) -> str | None:
        """Return the refusal, empty if carried out; None: it was not taken in time and is withdrawn."""
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
                return "the engine did not finish: see its log, and whether the change is in use"
        return self.refusal


@dataclass(frozen=True, slots=True)
class TestPicture:
    """Take an image of what lies there now and judge it; the PLC is not informed."""

    master: str = ""
    """Serial of the master that lies there, if it is one."""
    __test__ = False


@dataclass(frozen=True, slots=True)
class Service:
    """Begin, renew or end service mode; it lapses unless it is renewed in time."""

    who: str
    bit: int = 0
    """The one bit of STATUS to set by hand."""
    look: bool = False
    """Take setup images, one after the other."""
    exposure_us: float | None = None
    gain_db: float | None = None
    """For the setup images; None: as the settings say."""
    over: bool = False
    """The work is done."""


@dataclass(frozen=True, slots=True)
class Reload:
    """Read the settings again: the file was edited by hand."""

    asked_s: float = field(default_factory=time.time)
    """Epoch seconds."""
    ticket: Ticket = field(default_factory=Ticket)


@dataclass(frozen=True, slots=True)
class UseSettings:
    """Use changed settings that are loaded already, and put their file in place."""

    change: Change
    replace_file: Callable[[], None]
    """Puts the prepared file in place, atomically. Raises SettingsError."""
    ticket: Ticket = field(default_factory=Ticket)


@dataclass(frozen=True, slots=True)
class ResetCounts:
    """Set the counters back to 0."""

    who: str


Order = TestPicture | Service | Reload | UseSettings | ResetCounts


class OrderQueue:
    """Orders on their way from one thread to another; neither waits."""

    def __init__(self) -> None:
        self._waiting: deque[Order] = deque(maxlen=MAX_WAITING)

    def put(self, order: Order) -> None:
        """Hand over an order."""
        self._waiting.append(order)

    def take(self) -> list[Order]:
        """Return all orders that were handed over since, the oldest first."""
        return [self._waiting.popleft() for _ in range(len(self._waiting))]

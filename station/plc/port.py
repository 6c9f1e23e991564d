"""What the cycle needs of a line, whatever the wire."""

from dataclasses import dataclass
from typing import Protocol

from station.plc.registers import Flags, Offline, VerdictCode


@dataclass(frozen=True, slots=True)
class Trigger:
    """An accepted trigger: judge the part that is in the nest now."""

    trigger_id: int
    serial: str
    accepted_s: float
    """Monotonic time."""
    number: int
    """Counts accepted triggers; never repeats, unlike the PLC's 16-bit id."""


@dataclass(frozen=True, slots=True)
class Result:
    """What is published for one trigger. Scores x 10000; masks over segments."""

    trigger: Trigger
    verdict: VerdictCode
    inspection_id: int
    reason: int
    error_code: int
    seg_scores: tuple[int, ...]
    seg_nok_mask: int
    seg_invalid_mask: int
    flags: Flags


@dataclass(frozen=True, slots=True)
class Health:
    """What the station says of itself."""

    ready: bool
    """Camera, model and archive are fit for a part."""
    offline: Offline
    failure: bool
    """NE 107: failure."""
    config_crc: int
    out_of_spec: bool = False
    """NE 107: out of specification; the pictures drift, the parts are judged."""


class Line(Protocol):
    """A line: gives triggers, takes results."""

    def start(self) -> None:
        """Connect or listen. Raises LineError."""

    def stop(self) -> None:
        """Close; leaves nothing running."""

    def next_trigger(self, timeout_s: float) -> Trigger | None:
        """The next accepted trigger, or None."""

    def in_work(self, trigger: Trigger) -> bool:
        """Whether this trigger still waits for its answer; if not, its part may be gone."""

    def exposure_done(self, trigger: Trigger) -> None:
        """The picture is taken: the part may move."""

    def publish(self, result: Result) -> bool:
        """Offer a result; returns once it is readable. False if it came too late and was not shown."""

    def checked_in(self, health: Health) -> None:
        """The inspection is alive; call at least every 500 ms while idle."""

    def status(self) -> dict[str, int]:
        """STATUS, OFFLINE_REASON and HEARTBEAT as last published."""

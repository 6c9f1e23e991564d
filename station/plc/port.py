"""What the cycle needs of a line, independent of the transport."""

from dataclasses import dataclass, field
from typing import Protocol

from station.plc.map.registers import (
    BY_NAME,
    CommandCode,
    Control,
    Flags,
    Offline,
    Status,
    VerdictCode,
)

NO_SERIAL = (0,) * BY_NAME["PART_SERIAL"].words
"""Words of PART_SERIAL without a serial."""


@dataclass(frozen=True, slots=True)
class Trigger:
    """An accepted trigger: a request to inspect the part that is in the nest now."""

    trigger_id: int
    serial: str
    accepted_s: float
    """Monotonic time of acceptance."""
    number: int
    """Running number of accepted triggers; unlike the PLC's 16-bit id it never repeats."""
    golden: bool = field(default=False, kw_only=True)
    """True if a master is in the nest: the PLC always reads TEST."""
    serial_words: tuple[int, ...] = field(default=NO_SERIAL, kw_only=True)
    """Words of PART_SERIAL as the PLC wrote them; they are echoed unchanged, whatever text they hold."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command of the PLC that the station must carry out."""

    code: CommandCode
    arg: int
    number: int
    """Running number of such commands."""
    since_s: float
    """Monotonic time of the command."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Result:
    """Result published for one trigger; scores are multiplied by 10000, masks have one bit per segment."""

    trigger: Trigger
    verdict: VerdictCode
    inspection_id: int
    reason: int
    error_code: int
    seg_scores: tuple[int, ...]
    seg_nok_mask: int
    seg_invalid_mask: int
    flags: Flags


@dataclass(frozen=True, slots=True, kw_only=True)
class Health:
    """Health of the station, as published to the PLC."""

    ready: bool
    """True if camera, model and archive are ready for a part."""
    offline: Offline
    failure: bool
    """True for failure (NE 107)."""
    config_crc: int
    out_of_spec: bool = False
    """True for out of specification (NE 107): the images drift, parts are still judged."""
    function_check: bool = False
    """True for function check (NE 107): a master was misjudged or its check is due."""
    maintenance: bool = False
    """True for maintenance required (NE 107): the disk is nearly full."""
    recipe: int = 1
    """Number of the active recipe."""
    alarm: int = 0
    """Code of the most severe active alarm; 0: none."""
    bit: int = 0
    """Bit of STATUS that is set by hand in service mode; 0: none."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Numbers of parts by published verdict, since the start of the engine or the last reset."""

    ok: int = 0
    nok: int = 0
    error: int = 0

    @property
    def total(self) -> int:
        """Number of all parts, judged or not."""
        return self.ok + self.nok + self.error


@dataclass(frozen=True, slots=True, kw_only=True)
class LineState:
    """State of the line, decoded from the command window and the status window."""

    control: Control
    """Bits of CONTROL as last read."""
    status: Status
    """Bits of STATUS as last published."""
    offline: Offline
    """Reason why READY is 0."""
    error_code: int
    counts: Counts


class Line(Protocol):
    """A line that provides triggers and takes results."""

    def start(self) -> None:
        """Connect or listen. Raises LineError."""

    def stop(self) -> None:
        """Close the connection; nothing is left running."""

    def next_request(self, timeout_s: float) -> Trigger | Command | None:
        """Return the next accepted trigger or command; None if none came in time."""

    def awaits_command(self, command: Command) -> bool:
        """Return whether this command still waits to be carried out; if not, the PLC has read its refusal."""

    def command_done(self, command: Command, succeeded: bool) -> None:
        """Report that a command was carried out, or failed."""

    def awaits_result(self, trigger: Trigger) -> bool:
        """Return whether this trigger still waits for its result; if not, its part may have left the nest."""

    def exposure_done(self, trigger: Trigger) -> None:
        """Report that the image is taken: the part may move."""

    def publish(self, result: Result) -> bool:
        """Publish a result and return once the PLC can read it; False if it came too late."""

    def reset_counts(self) -> None:
        """Set the counters back to 0, as if the PLC had commanded it."""

    def check_in(self, health: Health) -> None:
        """Report that the inspection is alive, and its health; call at least every 500 ms while idle."""

    def state(self) -> LineState:
        """Return what the line reads and publishes now, decoded."""

    def windows(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Return the words of the command window as last read and of the status window as last published."""

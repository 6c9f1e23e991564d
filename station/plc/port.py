"""What the cycle needs of a line, whatever the wire."""

from dataclasses import dataclass, field
from typing import Protocol

from station.plc.map.registers import CommandCode, Control, Flags, Offline, Status, VerdictCode


@dataclass(frozen=True, slots=True)
class Trigger:
    """An accepted trigger: judge the part that is in the nest now."""

    trigger_id: int
    serial: str
    accepted_s: float
    """Monotonic time."""
    number: int
    """Counts accepted triggers; never repeats, unlike the PLC's 16-bit id."""
    golden: bool = field(default=False, kw_only=True)
    """A master lies in the nest: the answer is TEST whatever is found."""


@dataclass(frozen=True, slots=True)
class Command:
    """A command of the PLC that the station must carry out."""

    code: CommandCode
    arg: int
    number: int
    """Counts such commands."""
    since_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
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


@dataclass(frozen=True, slots=True, kw_only=True)
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
    function_check: bool = False
    """NE 107: a master was judged wrongly; no verdict counts until it is judged right."""
    maintenance: bool = False
    """NE 107: maintenance required; the disk fills."""
    recipe: int = 1
    """Number of the recipe in use."""
    alarm: int = 0
    """Code of the gravest alarm."""
    bit: int = 0
    """Bit of STATUS that is set by hand; only while someone works on the station."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Parts by what the PLC read, since the engine started or the counters were reset."""

    ok: int = 0
    nok: int = 0
    error: int = 0

    @property
    def total(self) -> int:
        """Number of all parts, judged or not."""
        return self.ok + self.nok + self.error


@dataclass(frozen=True, slots=True, kw_only=True)
class LineState:
    """What PLC and station read of each other now, decoded from both windows."""

    control: Control
    """Bits that the PLC holds, as read last."""
    status: Status
    """Bits that the PLC reads, as published last."""
    offline: Offline
    """Why READY is 0."""
    error_code: int
    counts: Counts


class Line(Protocol):
    """A line: gives triggers, takes results."""

    def start(self) -> None:
        """Connect or listen. Raises LineError."""

    def stop(self) -> None:
        """Close; leaves nothing running."""

    def next_request(self, timeout_s: float) -> Trigger | Command | None:
        """The next accepted trigger or command, or None."""

    def wanted(self, command: Command) -> bool:
        """Whether this command still waits to be carried out; if not, the PLC was told that it is refused."""

    def command_done(self, command: Command, well: bool) -> None:
        """A command was carried out, or refused."""

    def in_work(self, trigger: Trigger) -> bool:
        """Whether this trigger still waits for its answer; if not, its part may be gone."""

    def exposure_done(self, trigger: Trigger) -> None:
        """The picture is taken: the part may move."""

    def publish(self, result: Result) -> bool:
        """Offer a result; returns once it is readable. False if it came too late and was not shown."""

    def reset_counts(self) -> None:
        """Parts are counted from 0, as if the PLC had commanded it."""

    def checked_in(self, health: Health) -> None:
        """The inspection is alive; call at least every 500 ms while idle."""

    def state(self) -> LineState:
        """What the line reads and publishes now, decoded."""

    def windows(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Words of the command window as last read and of the status window as last published."""

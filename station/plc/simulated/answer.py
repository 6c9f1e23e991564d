"""What a simulated PLC can do wrong, and its decision on a part."""

from dataclasses import dataclass
from enum import StrEnum

from station.plc.map.registers import Flags, VerdictCode


class Fault(StrEnum):
    """A fault that can be injected on the PLC's side."""

    EARLY_DROP = "early trigger drop"
    STUCK_ACK = "stuck ack"
    ID_REUSE = "id reuse"
    WORD_ORDER = "wrong word order"
    TORN_READS = "torn reads"
    SILENCE = "silence"
    STORM = "reconnect storm"
    NO_REST = "start without rest"
    START_AGAIN = "start again while busy"
    BURST = "burst of requests"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """The PLC's decision on one part."""

    accepted: bool
    """True if the part passes: all points of the acceptance rule held in one read."""
    verdict: VerdictCode
    refused_by: str | None
    """First point of the rule that did not hold; None: all held."""
    trigger_to_valid_ms: float | None
    """Time from trigger to result; None if no result came in time."""
    inspection_id: int
    reason: int
    handshake_complete: bool
    """True if the trigger was acknowledged, the result read and acknowledged, and RESULT_VALID fell."""
    flags: Flags
    trigger_id: int

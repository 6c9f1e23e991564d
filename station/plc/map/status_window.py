"""Converts the handshake's state to the status window, and both windows back to a line state; pure."""

from station import __version__
from station.domain import SEGMENTS
from station.plc.handshake import ready
from station.plc.handshake_state import Phase, State
from station.plc.map.registers import (
    ALL_SEGMENTS,
    MAP_VERSION,
    TEST_F32,
    TEST_U32,
    Control,
    Offline,
    Status,
    Value,
    VerdictCode,
    named_bits,
    number,
)
from station.plc.port import Counts, Health, LineState

_MAJOR, _MINOR = map(int, __version__.split(".")[:2])
SW_VERSION = _MAJOR * 256 + _MINOR
"""Value of the register SW_VERSION."""


def values(state: State, health: Health, now_s: float, counts: Counts) -> dict[str, Value]:
    """Return the values of the whole status window by register name; `now_s` is monotonic."""
    shown = state.result if state.phase is Phase.SHOWN else None
    verdict = VerdictCode.NONE if shown is None else shown.verdict
    status = Status(0)
    for bit, on in (
        (Status.ONLINE, state.phase is not Phase.OFFLINE),
        (Status.READY, ready(state)),
        (Status.TRIGGER_ACK, state.trigger_ack),
        (Status.EXPOSURE_DONE, state.exposure_done),
        (Status.BUSY, state.phase in (Phase.WIPED, Phase.BUSY)),
        (Status.RESULT_VALID, shown is not None),
        (Status.OK, verdict is VerdictCode.OK),
        (Status.NOK, verdict is VerdictCode.NOK),
        (Status.ERROR, state.error),
        (Status.MISSED_TRIGGER, state.missed),
        (Status.CMD_DONE, state.cmd_done),
        (Status.MAINTENANCE, state.stuck or health.maintenance),
        (Status.FUNCTION_CHECK, health.function_check or verdict is VerdictCode.TEST),
        (Status.OUT_OF_SPEC, health.out_of_spec),
        (Status.FAILURE, health.failure),
    ):
        if on:
            status |= bit
    in_service = state.offline is Offline.SERVICE and state.phase is Phase.OFFLINE
    if in_service and health.bit:
        status = Status(health.bit)  # alone: an OK without RESULT_VALID releases nothing
    window: dict[str, Value] = {
        "STATUS": int(status),
        "HEARTBEAT": state.heartbeat,
        "SEQ_HEAD": state.sequence,
        "SEQ_TAIL": state.sequence,
        "ACK_TRIGGER_ID": state.last_id,
        "VERDICT": int(verdict),
        "VERDICT_INV": 0xFFFF ^ int(verdict),
        "ERROR_CODE": state.error_code or health.alarm,
        "ACTIVE_RECIPE": health.recipe,
        "CONFIG_CRC": health.config_crc,
        "SEG_COUNT": SEGMENTS,
        "SEG_INVALID_MASK": ALL_SEGMENTS,
        "MODE": 3 if in_service else 1 if state.phase is not Phase.OFFLINE else 2,
        "OFFLINE_REASON": int(state.offline),
        "CMD_ECHO": state.cmd_echo,
        "COUNT_OK": counts.ok,
        "COUNT_NOK": counts.nok,
        "COUNT_ERROR": counts.error,
        "TEST_U32": TEST_U32,
        "TEST_F32": TEST_F32,
        "MAP_VERSION": MAP_VERSION,
        "SW_VERSION": SW_VERSION,
    }
    if shown is not None:
        worst = max(range(len(shown.seg_scores)), key=lambda segment: shown.seg_scores[segment], default=0)
        window |= {
            "RESULT_TRIGGER_ID": shown.trigger.trigger_id,
            "INSPECTION_ID": shown.inspection_id & 0xFFFFFFFF,
            "REASON": shown.reason,
            "SEG_NOK_MASK": shown.seg_nok_mask,
            "SEG_INVALID_MASK": shown.seg_invalid_mask,
            "T_PROCESS_MS": state.process_ms,
            "RESULT_AGE_10MS": min(0xFFFF, int((now_s - state.shown_s) * 100)),
            "SERIAL_ECHO": shown.trigger.serial_words,
            "FLAGS": int(shown.flags),
        }
        if shown.seg_scores:
            window |= {
                "SEG_SCORE": shown.seg_scores,
                "WORST_SEG": worst,
                "WORST_SCORE": shown.seg_scores[worst],
            }
    return window


def decoded(command: dict[str, Value], status: dict[str, Value]) -> LineState:
    """Return the line state from the values of the command window and of the status window."""
    return LineState(
        control=named_bits(Control, number(command, "CONTROL")),
        status=named_bits(Status, number(status, "STATUS")),
        offline=Offline(number(status, "OFFLINE_REASON")),
        error_code=number(status, "ERROR_CODE"),
        counts=Counts(number(status, "COUNT_OK"), number(status, "COUNT_NOK"), number(status, "COUNT_ERROR")),
    )

"""Events as an engine sends them."""

import time
from dataclasses import replace

from station.answer import verdict_code
from station.domain import Inspection, Origin, Purpose
from station.events import Counts, PartEvent, StatusEvent
from station.plc.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS, Offline, Status, Value, VerdictCode, pack_window
from tests.parts import record


def status(
    offline: Offline = Offline.NONE,
    origin: Origin = Origin.SIMULATED,
    camera: str = "",
    service: str = "",
    alarms: tuple[int, ...] = (),
    counts: Counts | None = None,
    at_s: float | None = None,
    started_s: float = 0.0,
    reloaded_s: float = 0.0,
) -> StatusEvent:
    """`camera`: why it is not there; `at_s`: now, if not given."""
    bits = Status.ONLINE | Status.READY if offline is Offline.NONE else Status(0)
    values: dict[str, Value] = {"STATUS": int(bits), "OFFLINE_REASON": int(offline), "TEST_U32": 0x12345678, "TEST_F32": 123.456}
    c = counts or Counts(3, 1, 0)
    values |= {"COUNT_OK": c.ok, "COUNT_NOK": c.nok, "COUNT_ERROR": c.error}
    words = tuple(pack_window(STATUS_START, STATUS_WORDS, values))
    at_s = time.monotonic() if at_s is None else at_s
    return StatusEvent(at_s, started_s, reloaded_s, not camera, camera, origin, (0,) * COMMAND_WORDS, words, alarms, service=service)


def part(
    inspection: Inspection,
    number: int = 1,
    origin: Origin = Origin.CAMERA,
    purpose: Purpose = Purpose.PART,
    at_s: float | None = None,
    trusted: bool = True,
) -> PartEvent:
    """Judged and shown to the PLC, now if `at_s` is not given."""
    made = replace(record(inspection, number, origin), purpose=purpose)
    nok = tuple(s.nok > 0.5 for s in inspection.scores)
    told = VerdictCode.NONE if purpose is Purpose.TEST else verdict_code(made, trusted)
    return PartEvent(time.monotonic() if at_s is None else at_s, made, nok, False, None, told, 1.0, 1.0)

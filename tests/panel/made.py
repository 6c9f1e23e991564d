"""Events as an engine sends them."""

from dataclasses import replace

from station.domain import Inspection, Origin, Purpose
from station.events import Counts, PartEvent, StatusEvent
from station.plc.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS, Offline, Status, Value, pack_window
from tests.parts import record


def status(
    offline: Offline = Offline.NONE,
    origin: Origin = Origin.SIMULATED,
    camera: str = "",
    service: str = "",
    alarms: tuple[int, ...] = (),
    counts: Counts | None = None,
) -> StatusEvent:
    """`camera`: why it is not there."""
    bits = Status.ONLINE | Status.READY if offline is Offline.NONE else Status(0)
    values: dict[str, Value] = {"STATUS": int(bits), "OFFLINE_REASON": int(offline), "TEST_U32": 0x12345678, "TEST_F32": 123.456}
    words = tuple(pack_window(STATUS_START, STATUS_WORDS, values))
    return StatusEvent(not camera, camera, origin, counts or Counts(3, 1, 0), (0,) * COMMAND_WORDS, words, alarms, service=service)


def part(inspection: Inspection, number: int = 1, origin: Origin = Origin.CAMERA, purpose: Purpose = Purpose.PART) -> PartEvent:
    """Judged and shown to the PLC."""
    made = replace(record(inspection, number, origin), purpose=purpose)
    nok = tuple(s.nok > 0.5 for s in inspection.scores)
    return PartEvent(made, nok, False, None, purpose is Purpose.PART, 1.0, 1.0)

"""Events as an engine sends them, and a person who logs in."""

import time
from dataclasses import replace

from pytestqt.qtbot import QtBot

from station.channel.events import PartEvent, StatusEvent
from station.channel.requests import Answer
from station.domain import Inspection, Origin, Purpose
from station.engine.plc_result import verdict_code
from station.journal.users import Level, User
from station.panel.session.pending import NO_CONNECTION
from station.panel.session.session import Session
from station.plc.map.registers import (
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    Offline,
    Status,
    Value,
    VerdictCode,
    pack_window,
    unpack_window,
)
from station.plc.map.status_window import decoded
from station.plc.port import Counts
from tests.desk import PIN, Desk
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
) -> StatusEvent:
    """`camera`: why it is not there; `at_s`: now, if not given."""
    bits = Status.ONLINE | Status.READY if offline is Offline.NONE else Status(0)
    values: dict[str, Value] = {
        "STATUS": int(bits),
        "OFFLINE_REASON": int(offline),
        "TEST_U32": 0x12345678,
        "TEST_F32": 123.456,
    }
    c = counts or Counts(3, 1, 0)
    values |= {"COUNT_OK": c.ok, "COUNT_NOK": c.nok, "COUNT_ERROR": c.error}
    command_words, status_words = [0] * COMMAND_WORDS, pack_window(STATUS_START, STATUS_WORDS, values)
    return StatusEvent(
        at_s=time.monotonic() if at_s is None else at_s,
        started_s=started_s,
        camera_there=not camera,
        camera_message=camera,
        origin=origin,
        line=decoded(unpack_window(COMMAND_START, command_words), unpack_window(STATUS_START, status_words)),
        command_words=tuple(command_words),
        status_words=tuple(status_words),
        alarms=alarms,
        service=service,
    )


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
    told = VerdictCode.NONE if purpose is Purpose.TEST else verdict_code(made, trusted)
    return PartEvent(
        at_s=time.monotonic() if at_s is None else at_s,
        record=made,
        novel=False,
        drift=None,
        reported=told,
        record_ms=1.0,
        publish_ms=1.0,
    )


def log_in(session: Session, desk: Desk, qtbot: QtBot, name: str, level: Level) -> None:
    """A user of that level, logged in at the window by the engine."""
    desk.knows(name, level)
    answers: list[Answer] = []
    while not answers or answers[-1].refusal == NO_CONNECTION:  # not connected yet
        count = len(answers)
        session.account.log_in(name, PIN, answers.append)
        qtbot.waitUntil(lambda: len(answers) > count, timeout=10_000)  # noqa: B023 - waited for here
        qtbot.wait(20)
    assert session.account.user == User(name, level)

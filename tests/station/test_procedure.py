"""Part, test image and master go one way: the same judgement and record, but only a trigger is answered."""

import re
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from station.archive.reader import read_records
from station.archive.writer import Archive
from station.camera.reconnecting import Grab, ReconnectingCamera
from station.channel.events import Event, PartEvent
from station.defects import Reason
from station.domain import Frame, Image, Origin, Purpose, Verdict
from station.engine.alarm_log import AlarmLog
from station.engine.listener import Listener
from station.engine.procedure import Procedure
from station.engine.self_checks import Master, SelfChecks
from station.errors import CameraLost, FrameDamaged, FrameTimeout, FrameUnrequested
from station.inspection.inspector import Inspector
from station.inspection.loading import Loaded
from station.plc.line import make_line
from station.plc.map.codes import ERROR_ABORTED, ERROR_DEADLINE
from station.plc.map.registers import VerdictCode
from station.plc.port import Health, LineState, Result, Trigger
from station.settings.model import ArchiveSettings, PlcSettings
from tests.parts import label_with, provenance

TRIGGER = Trigger(trigger_id=7, serial="CELL-7", accepted_s=0.0, number=1)


class Camera:
    """A camera that gives one frame again and again, or fails in one way."""

    def __init__(self, image: Image, fault: Exception | None = None) -> None:
        self.image, self.fault = image, fault
        self.adjusted: list[tuple[float | None, float | None]] = []

    def open(self) -> None: ...

    def grab(self, trigger_s: float) -> Frame:
        if self.fault is not None:
            raise self.fault
        return Frame(self.image, datetime.now(UTC), "cam", Origin.CAMERA)

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        self.adjusted.append((exposure_us, gain_db))

    def alive(self) -> bool:
        return True

    def close(self) -> None: ...


@dataclass
class Line:
    """What a procedure needs of a line; keeps what it is given."""

    working: bool = True
    in_time: bool = True
    line_state: LineState = field(default_factory=lambda: make_line(PlcSettings()).state())
    published: list[Result] = field(default_factory=list)
    exposed: list[Trigger] = field(default_factory=list)

    def awaits_result(self, _trigger: Trigger) -> bool:
        return self.working

    def exposure_done(self, trigger: Trigger) -> None:
        self.exposed.append(trigger)

    def publish(self, result: Result) -> bool:
        self.published.append(result)
        return self.in_time

    def check_in(self, _health: Health) -> None: ...

    def state(self) -> LineState:
        return self.line_state


class Rig:
    """A procedure with the production camera guard, archive, watch and networks."""

    def __init__(
        self, folder: Path, camera: Camera, inspector: Inspector, alarm_log: AlarmLog, archive: Archive
    ) -> None:
        self.folder, self.camera, self.line = folder, camera, Line()
        self.events: list[Event] = []
        self.shown: list[int] = []
        self.checked_in = 0
        self.loaded = Loaded(1, inspector, provenance(), None)
        self.self_checks = SelfChecks(self.loaded, {"MASTER": Master(Verdict.NOK)}, None, 1e9)
        guarded = ReconnectingCamera(camera, 1.0)
        guarded.keep_open()
        self.procedure = Procedure(
            camera=guarded,
            origin=Origin.SIMULATED,
            line=self.line,  # type: ignore[arg-type]
            archive=archive,
            self_checks=self.self_checks,
            listener=Listener(self.events.append, lambda preview: self.shown.append(preview.inspection_id)),
            alarm_log=alarm_log,
            check_in=self._check_in,
        )

    def _check_in(self) -> None:
        self.checked_in += 1

    @property
    def event(self) -> PartEvent:
        (event,) = self.events
        assert isinstance(event, PartEvent)
        return event


@pytest.fixture
def rig(tmp_path: Path, frames: dict[str, Image], inspector: Inspector) -> Iterator[Rig]:
    settings = ArchiveSettings(folder=tmp_path, min_free_mb=1, thin_free_mb=1, warn_free_mb=1)
    camera = Camera(frames[label_with("hole")["frame"]])
    with closing(Archive(settings)) as archive, closing(AlarmLog(tmp_path)) as alarm_log:
        yield Rig(tmp_path, camera, inspector, alarm_log, archive)


ASKED: dict[str, tuple[Callable[[Rig], None], Purpose, VerdictCode, str]] = {
    "part": (lambda r: r.procedure.inspect_part(TRIGGER, r.loaded), Purpose.PART, VerdictCode.NOK, "CELL-7"),
    "master, by the PLC": (
        lambda r: r.procedure.inspect_part(replace(TRIGGER, serial="MASTER", golden=True), r.loaded),
        Purpose.GOLDEN,
        VerdictCode.TEST,
        "MASTER",
    ),
    "test image": (lambda r: r.procedure.inspect_now("", r.loaded), Purpose.TEST, VerdictCode.NONE, ""),
    "master, by a person": (
        lambda r: r.procedure.inspect_now("MASTER", r.loaded),
        Purpose.GOLDEN,
        VerdictCode.NONE,
        "MASTER",
    ),
}


@pytest.mark.parametrize("asked", list(ASKED))
def test_all_are_judged_recorded_and_shown_alike_but_only_a_trigger_is_answered(rig: Rig, asked: str) -> None:
    inspect, purpose, told, serial = ASKED[asked]
    by_plc = told is not VerdictCode.NONE
    inspect(rig)
    event, record = rig.event, rig.event.record
    assert (record.verdict, record.inspection.reason, record.purpose) == (Verdict.NOK, Reason.HOLE, purpose)
    assert (record.serial, record.trigger_id) == (serial, TRIGGER.trigger_id if by_plc else 0)
    assert record.origin is Origin.CAMERA, "of the frame, not of the settings"
    assert any(event.record.inspection.nok)
    assert event.record_ms > 0
    assert event.reported is told
    assert [entry.record for entry in read_records(rig.folder)] == [record]
    assert rig.shown == [record.inspection_id]
    assert [result.verdict for result in rig.line.published] == ([told] if by_plc else [])
    assert len(rig.line.exposed) == rig.checked_in == int(by_plc)
    assert (rig.self_checks._masters["MASTER"].found is Verdict.NOK) == (purpose is Purpose.GOLDEN)


def test_a_part_whose_trigger_is_over_is_recorded_without_a_grab(rig: Rig) -> None:
    rig.line.working = rig.line.in_time = False
    rig.line.line_state = replace(rig.line.line_state, error_code=ERROR_ABORTED)
    rig.procedure.inspect_part(TRIGGER, rig.loaded)
    record = rig.event.record
    assert (record.verdict, record.inspection.reason) == (Verdict.ERROR, Reason.ABORTED)
    assert record.inspection.timing.grab_ms is None
    assert record.origin is Origin.SIMULATED
    assert rig.event.reported is VerdictCode.ERROR
    assert not rig.camera.adjusted
    assert not rig.line.exposed
    assert not rig.shown


@pytest.mark.parametrize(("said", "code"), [(ERROR_ABORTED, ERROR_ABORTED), (0, ERROR_DEADLINE)])
def test_a_result_that_came_too_late_is_an_alarm_with_the_code_that_the_plc_reads(
    rig: Rig, said: int, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    passed: list[int] = []
    monkeypatch.setattr(AlarmLog, "add_event", lambda _self, code, _what: passed.append(code))
    rig.line.in_time = False
    rig.line.line_state = replace(rig.line.line_state, error_code=said)
    rig.procedure.inspect_part(TRIGGER, rig.loaded)
    assert rig.event.reported is VerdictCode.ERROR
    assert rig.event.record.verdict is Verdict.NOK
    assert passed == [code]


FAULTS = [
    (FrameTimeout("late"), Reason.NO_FRAME, True),
    (FrameDamaged("torn"), Reason.INCOMPLETE_FRAME, True),
    (FrameDamaged("small", wrong_size=True), Reason.WRONG_SIZE, True),
    (FrameUnrequested("frames were lost"), Reason.NOT_OF_TRIGGER, True),
    (CameraLost("gone"), Reason.CAMERA_LOST, False),
    (ValueError("unforeseen"), Reason.INTERNAL, False),
]


@pytest.mark.parametrize(("fault", "reason", "connected"), FAULTS)
def test_a_grab_that_fails_is_a_reason(rig: Rig, fault: Exception, reason: Reason, connected: bool) -> None:
    rig.camera.fault = fault
    rig.procedure.inspect_part(TRIGGER, rig.loaded)
    inspection = rig.event.record.inspection
    assert (inspection.verdict, inspection.reason) == (Verdict.ERROR, reason)
    assert inspection.timing.grab_ms is not None
    assert [result.reason for result in rig.line.published] == [reason.code]
    assert rig.procedure._camera.connected is connected


def test_a_grab_has_a_frame_or_a_reason_never_both_nor_neither() -> None:
    with pytest.raises(ValueError, match="or the reason"):
        Grab(None, None, 1.0)


def test_a_network_that_fails_ends_in_error_after_a_grab(rig: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(Inspector, "inspect", fails)
    rig.procedure.inspect_now("", rig.loaded)
    inspection = rig.event.record.inspection
    assert (inspection.verdict, inspection.reason) == (Verdict.ERROR, Reason.INTERNAL)
    assert inspection.timing.grab_ms is not None


def test_images_too_small_for_the_weld_are_named_in_the_log(
    rig: Rig, caplog: pytest.LogCaptureFixture
) -> None:
    rig.camera.image = np.full((1000, 1600), 90, np.uint8)
    rig.procedure.inspect_part(TRIGGER, rig.loaded)
    assert rig.event.record.verdict is Verdict.ERROR
    (line,) = [record.getMessage() for record in caplog.records if record.levelname == "ERROR"]
    assert "images of 1600 x 1000 px are too small for a radius of 5.564 + 0.156 mm at 13 µm/px" in line


def test_the_numbers_of_a_part_that_was_not_judged_reach_record_event_journal_and_log(
    rig: Rig, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    journal: list[str] = []
    monkeypatch.setattr(AlarmLog, "add_event", lambda _self, _code, what: journal.append(what))
    rig.camera.image = np.full_like(rig.camera.image, 90)
    rig.procedure.inspect_part(TRIGGER, rig.loaded)
    detail = rig.event.record.inspection.detail
    assert detail is not None
    assert re.fullmatch(r"no weld found: the best circle scores -?\d\.\d\d, minimum is 0\.25", detail)
    (entry,) = read_records(rig.folder)
    assert entry.record is not None
    assert entry.record.inspection.detail == detail
    assert journal == [f"part {entry.record.inspection_id}, {detail}"]
    assert detail in caplog.text


def test_a_trigger_that_got_no_answer_is_shown_as_error_without_a_record(rig: Rig) -> None:
    rig.procedure.show_error(TRIGGER, rig.loaded)
    assert (rig.event.reported, rig.event.record.verdict) == (VerdictCode.ERROR, Verdict.ERROR)
    assert rig.event.record.inspection_id == 0
    assert not list(read_records(rig.folder))

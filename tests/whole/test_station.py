"""Camera to verdict to PLC, every part the production one: emulated camera, engine, Modbus, simulated line."""

import asyncio
import hashlib
import os
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from deploy.demo import free_ports
from station.archive import Archive, read_records
from station.classify.drift import Reference, write_reference
from station.classify.onnx import LOOK
from station.cycle import Cycle, Listener
from station.domain import Image, Reason, Verdict
from station.errors import RecordError
from station.events import Event, PartEvent
from station.plc.modbus import ModbusServerLine
from station.plc.registers import REASON_CODES, Flags, VerdictCode
from station.plc.simulated_line import Answer, SimulatedLine
from station.settings import PylonSettings, Settings
from station.startup import load_inspector, make_camera
from synth.feed import Feed
from tests.conftest import MODEL, RING_MODEL
from tests.parts import label_with, labels

Judge = Callable[[SimulatedLine], "asyncio.Future[None]"]


@dataclass
class Station:
    """A running engine."""

    feed: Feed
    port: int
    folder: Path
    events: list[Event]

    def run(self, parts: list[Image | None], accept_simulated: bool = True) -> list[Answer]:
        """Pass parts through the line; None: no picture before the camera."""

        async def drive() -> list[Answer]:
            line = SimulatedLine("127.0.0.1", self.port, accept_simulated)
            await line.connect()
            answers = []
            try:
                for number, image in enumerate(parts):
                    self.feed.withdraw() if image is None else self.feed.show(image)
                    answers.append(await line.inspect(f"T{number}"))
            finally:
                line.close()
            return answers

        return asyncio.run(drive())

    def part_events(self) -> list[PartEvent]:
        return [e for e in self.events if isinstance(e, PartEvent)]


@pytest.fixture
def settings(tmp_path: Path, request: pytest.FixtureRequest) -> Settings:
    """A parameter: limit of drift from a reference that nothing looks like."""
    reference = None
    if hasattr(request, "param"):
        reference = tmp_path / "line.json"
        model_hash = hashlib.sha256(MODEL.read_bytes()).hexdigest()
        write_reference(reference, Reference(model_hash, 20, (9.0,) * LOOK, (1.0,) * LOOK, request.param))
    return Settings.model_validate(
        {
            "camera": {"kind": "pylon", "device_class": "BaslerCamEmu", "serial": "0815-0000", "reconnect_s": 0.1},
            "model": {"path": MODEL, "ring_path": RING_MODEL, "reference_path": reference},
            "archive": {"folder": tmp_path / "records", "min_free_mb": 1},
            "plc": {"port": free_ports(1)[0], "deadline_ms": 5000},
        }
    )


@pytest.fixture
def station(settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Station]:
    feed = Feed(tmp_path / "feed")
    for name, value in feed.environment.items():
        monkeypatch.setenv(name, value)
    events: list[Event] = []
    inspector, provenance = load_inspector(settings)
    archive, line = Archive(settings.archive), ModbusServerLine(settings.plc)
    line.start()
    assert isinstance(settings.camera, PylonSettings)
    cycle = Cycle(
        make_camera(settings), settings.camera.origin, line, inspector, archive, provenance, Listener(events.append, lambda _: None), 0.1
    )
    stop = threading.Event()
    thread = threading.Thread(target=cycle.run, args=(stop,), name="cycle")
    thread.start()
    yield Station(feed, line.port, settings.archive.folder, events)
    stop.set()
    thread.join(timeout=10)
    line.stop()
    archive.close()
    assert not thread.is_alive()


def test_every_part_is_judged_recorded_and_answered(station: Station, frames: dict[str, Image]) -> None:
    items = labels()
    answers = station.run([frames[item["frame"]] for item in items])
    for item, answer in zip(items, answers, strict=True):
        assert answer.accepted == (item["verdict"] == "OK"), (item["frame"], answer)
        assert answer.verdict is VerdictCode[item["verdict"]]
        assert answer.handshake_complete
    records = list(read_records(station.folder))
    assert [(r.inspection_id, r.serial, str(r.verdict)) for e in records if (r := e.record) is not None] == [
        (answer.inspection_id, f"T{i}", item["verdict"]) for i, (item, answer) in enumerate(zip(items, answers, strict=True))
    ]
    assert not [e.problem for e in records if e.problem]


def test_a_plc_that_takes_no_simulated_pictures_passes_nothing(station: Station, frames: dict[str, Image]) -> None:
    (answer,) = station.run([frames[label_with("OK")["frame"]]], accept_simulated=False)
    assert answer.verdict is VerdictCode.OK
    assert not answer.accepted
    assert answer.refused_by == "picture of an emulated camera"


@pytest.mark.parametrize(("settings", "parts_until_alarm"), [(15.0, 3), (1e6, None)], indirect=["settings"])
def test_drifting_pictures_are_told_to_plc_and_window_and_still_judged(
    station: Station, parts_until_alarm: int | None, frames: dict[str, Image]
) -> None:
    answers = station.run([frames[label_with("OK")["frame"]]] * 3)
    assert [a.verdict for a in answers] == [VerdictCode.OK] * 3
    drifts = [e.drift for e in station.part_events()]
    alarms = [d is not None and d.alarm for d in drifts]
    assert alarms == [i + 1 == parts_until_alarm for i in range(3)], drifts
    assert [Flags.DRIFT in a.flags for a in answers] == alarms


def test_what_cannot_be_judged_is_error_and_the_next_part_goes_on(station: Station, frames: dict[str, Image]) -> None:
    good = frames[label_with("OK")["frame"]]
    black = good * 0
    answers = station.run([None, good[:1000, :2000], black, good])
    assert [a.verdict for a in answers] == [VerdictCode.ERROR] * 3 + [VerdictCode.OK]
    reasons = [Reason.INCOMPLETE_FRAME, Reason.WRONG_SIZE, Reason.NO_WELD_FOUND]
    assert [a.reason for a in answers[:3]] == [REASON_CODES[r] for r in reasons]
    assert all(a.handshake_complete for a in answers)
    assert [r.verdict for e in read_records(station.folder) if (r := e.record) is not None] == [Verdict.ERROR] * 3 + [Verdict.OK]


def test_a_record_that_cannot_be_written_is_error(station: Station, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_arguments: object) -> None:
        raise RecordError("disk full")

    monkeypatch.setattr(Archive, "commit", full)
    (answer,) = station.run([frames[label_with("OK")["frame"]]])
    assert (answer.verdict, answer.reason) == (VerdictCode.ERROR, REASON_CODES[Reason.RECORD_FAILED])
    assert not answer.accepted


def test_the_verdict_is_seen_only_after_its_record_is_on_disk(
    station: Station, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    listed: list[int] = []
    publish = ModbusServerLine.publish

    def look_first(line: ModbusServerLine, result: object) -> bool:
        listed.append(sum(e.problem is None for e in read_records(station.folder)))
        return publish(line, result)  # type: ignore[arg-type]

    monkeypatch.setattr(ModbusServerLine, "publish", look_first)
    station.run([frames[label_with("OK")["frame"]]] * 2)
    assert listed == [1, 2]


def test_a_camera_that_is_absent_at_start_is_said_and_found_later(station: Station, settings: Settings, frames: dict[str, Image]) -> None:
    os.environ["PYLON_CAMEMU"] = "0"

    async def absent_then_back() -> Answer:
        line = SimulatedLine("127.0.0.1", station.port, accept_simulated=True)
        await line.connect()
        try:
            return await line.inspect("back", window_s=10.0)
        finally:
            line.close()

    station.feed.show(frames[label_with("OK")["frame"]])
    back = threading.Timer(1.0, lambda: os.environ.update(PYLON_CAMEMU="1"))
    back.start()
    answer = asyncio.run(absent_then_back())
    back.join()
    assert answer.accepted

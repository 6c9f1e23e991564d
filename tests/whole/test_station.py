"""Camera to verdict to PLC with the production parts: emulated camera, engine, Modbus, simulated line."""

import asyncio
import hashlib
import os
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest

from deploy.demo.ports import free_ports
from station.archive.reader import read_records
from station.archive.writer import Archive
from station.camera.pylon import PylonCamera
from station.channel.events import Event, PartEvent
from station.classify.drift import Reference, write_reference
from station.classify.onnx import APPEARANCE_SIZE
from station.defects import Reason
from station.domain import Frame, Image, Purpose, Verdict
from station.engine.alarm_log import AlarmLog
from station.engine.listener import Listener
from station.engine.orders import Order, TestImage
from station.engine.self_checks import SelfChecks
from station.engine.startup import make_cycle
from station.errors import ModelError, RecordError
from station.inspection.loading import prepare
from station.plc.line import ModbusLine, make_line
from station.plc.map.registers import CommandCode, Flags, VerdictCode
from station.plc.simulated.line import Answer, SimulatedLine
from station.settings.model import Settings
from synth.camera.feed import Feed
from tests.conftest import MODEL, RING_MODEL, SEEN_MODEL
from tests.parts import label_with, labels

WINDOW_S = 60.0
"""Time in which the PLC waits: of no meaning here, and long enough for a machine that is busy."""
Judge = Callable[[SimulatedLine], "asyncio.Future[None]"]


@dataclass
class Station:
    """A running engine."""

    feed: Feed
    port: int
    folder: Path
    events: list[Event]
    asked: list[Order]

    def run(self, parts: list[Image | None], accept_simulated: bool = True) -> list[Answer]:
        """Pass parts through the line; None: no picture before the camera."""

        async def drive() -> list[Answer]:
            line = SimulatedLine.at("127.0.0.1", self.port, accept_simulated)
            await line.connect()
            answers = []
            try:
                for number, image in enumerate(parts):
                    self.feed.withdraw() if image is None else self.feed.show(image)
                    answers.append(await line.inspect(f"T{number}", WINDOW_S))
            finally:
                await line.close()
            return answers

        return asyncio.run(drive())

    def part_events(self, count: int) -> list[PartEvent]:
        """The first events of parts; each follows the answer to the PLC, so they are waited for."""
        until = time.monotonic() + WINDOW_S
        while (
            len(found := [e for e in self.events if isinstance(e, PartEvent)]) < count
            and time.monotonic() < until
        ):
            time.sleep(0.02)
        return found


@pytest.fixture
def settings(tmp_path: Path, request: pytest.FixtureRequest) -> Settings:
    """A parameter: limit of drift from a reference that nothing looks like."""
    reference = None
    if hasattr(request, "param"):
        reference = tmp_path / "line.json"
        model_hash = hashlib.sha256(MODEL.read_bytes()).hexdigest()
        write_reference(
            reference,
            Reference(
                model_hash=model_hash,
                parts=20,
                mean=(9.0,) * APPEARANCE_SIZE,
                spread=(1.0,) * APPEARANCE_SIZE,
                limit=request.param,
            ),
        )
    return Settings.model_validate(
        {
            "camera": {
                "kind": "pylon",
                "device_class": "BaslerCamEmu",
                "serial": "0815-0000",
                "reconnect_s": 0.1,
                "timeout_ms": 10_000,
            },
            "model": {
                "path": MODEL,
                "ring_path": RING_MODEL,
                "seen_path": SEEN_MODEL,
                "reference_path": reference,
            },
            "archive": {
                "folder": tmp_path / "records",
                "min_free_mb": 1,
                "thin_free_mb": 1,
                "warn_free_mb": 1,
            },
            "plc": {"port": free_ports(1)[0], "deadline_ms": 50_000},
            "golden": {"masters": {"MASTER-OK": "OK", "MASTER-NOK": "NOK"}},
            "recipes": {
                2: {"model": {"limits": {"hole": {"threshold": 0.0001}}}},
                3: {"model": {"path": tmp_path / "absent.onnx"}},
            },
        }
    )


@pytest.fixture
def station(settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Station]:
    feed = Feed(tmp_path / "feed")
    for name, value in feed.environment.items():
        monkeypatch.setenv(name, value)
    events: list[Event] = []
    loaded = prepare(settings, 1)
    archive, line = Archive(settings.archive), make_line(settings.plc)
    line.start()
    asked: list[Order] = []

    def orders() -> list[Order]:
        taken = asked.copy()
        del asked[: len(taken)]
        return taken

    alarm_log = AlarmLog(settings.archive.folder)
    listener = Listener(events.append, lambda _: None, orders)
    cycle = make_cycle(settings, loaded, line=line, archive=archive, listener=listener, alarm_log=alarm_log)
    stop = threading.Event()
    thread = threading.Thread(target=cycle.run, args=(stop,), name="cycle")
    thread.start()
    yield Station(feed, line.port, settings.archive.folder, events, asked)
    stop.set()
    thread.join(timeout=100)
    line.stop()
    alarm_log.close()
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
        (answer.inspection_id, f"T{i}", item["verdict"])
        for i, (item, answer) in enumerate(zip(items, answers, strict=True))
    ]
    assert not [e.problem for e in records if e.problem]


def test_a_plc_that_takes_no_simulated_pictures_passes_nothing(
    station: Station, frames: dict[str, Image]
) -> None:
    (answer,) = station.run([frames[label_with("OK")["frame"]]], accept_simulated=False)
    assert answer.verdict is VerdictCode.OK
    assert not answer.accepted
    assert answer.refused_by == "picture of an emulated camera"


@pytest.mark.parametrize(("settings", "parts_until_alarm"), [(4.5, 3), (1e6, None)], indirect=["settings"])
def test_drifting_pictures_are_told_to_plc_and_window_and_still_judged(
    station: Station, parts_until_alarm: int | None, frames: dict[str, Image]
) -> None:
    answers = station.run([frames[label_with("OK")["frame"]]] * 3)
    assert [a.verdict for a in answers] == [VerdictCode.OK] * 3
    drifts = [e.drift for e in station.part_events(3)]
    alarms = [d is not None and d.alarm for d in drifts]
    assert alarms == [i + 1 == parts_until_alarm for i in range(3)], drifts
    assert [Flags.DRIFT in a.flags for a in answers] == alarms


def test_a_recipe_is_changed_by_command_and_a_broken_one_leaves_the_old_in_use(
    station: Station, frames: dict[str, Image]
) -> None:
    good = frames[label_with("OK")["frame"]]

    async def drive() -> list[object]:
        line = SimulatedLine.at("127.0.0.1", station.port, accept_simulated=True)
        await line.connect()
        station.feed.show(good)
        seen: list[object] = [(await line.inspect("ONE", WINDOW_S)).verdict]
        crc = line.status()["CONFIG_CRC"]
        seen.append(await line.command(CommandCode.LOAD_RECIPE, 2))
        assert await line.wait_ready(WINDOW_S)
        seen += [line.status()["ACTIVE_RECIPE"], line.status()["CONFIG_CRC"] != crc]
        answer = await line.inspect("TWO", WINDOW_S)
        seen += [answer.verdict, answer.refused_by]
        seen += [await line.command(CommandCode.LOAD_RECIPE, number) for number in (3, 9)]
        assert await line.wait_ready(WINDOW_S)
        seen += [line.status()["ACTIVE_RECIPE"], await line.command(CommandCode.LOAD_RECIPE, 1)]
        seen.append((await line.inspect("THREE", WINDOW_S)).accepted)
        await line.close()
        return seen

    seen = asyncio.run(drive())
    assert seen[:4] == [VerdictCode.OK, 2, 2, True]
    assert seen[4] is VerdictCode.NOK, "with a threshold of almost nothing every part is refused"
    assert seen[6:] == [0xFFFF, 0xFFFF, 2, CommandCode.LOAD_RECIPE, True]
    recipes = [r.provenance.recipe for e in read_records(station.folder) if (r := e.record) is not None]
    assert recipes == [1, 2, 1]


def test_a_test_picture_is_judged_and_recorded_and_the_plc_is_told_nothing(
    station: Station, frames: dict[str, Image]
) -> None:
    (before,) = station.run([frames[label_with("OK")["frame"]]])
    station.asked.append(TestImage())
    event = station.part_events(2)[-1]
    assert (event.record.purpose, event.record.verdict, event.reported) == (
        Purpose.TEST,
        Verdict.OK,
        VerdictCode.NONE,
    )

    async def look() -> dict[str, object]:
        line = SimulatedLine.at("127.0.0.1", station.port, accept_simulated=True)
        await line.connect()
        await line.wait_ready(WINDOW_S)
        await line.close()
        return dict(line.status())

    seen = asyncio.run(look())
    assert (seen["VERDICT"], seen["ACK_TRIGGER_ID"], seen["COUNT_OK"]) == (0, before.trigger_id, 1)
    assert [r.purpose for e in read_records(station.folder) if (r := e.record) is not None] == [
        Purpose.PART,
        Purpose.TEST,
    ]


def test_a_master_never_passes_and_one_judged_wrongly_blocks_until_it_is_right(
    station: Station, frames: dict[str, Image]
) -> None:
    good, bad = frames[label_with("OK")["frame"]], frames[label_with("hole")["frame"]]

    async def drive() -> list[tuple[VerdictCode, str | None]]:
        line = SimulatedLine.at("127.0.0.1", station.port, accept_simulated=True)
        await line.connect()
        seen = []
        for serial, image, golden in (
            ("MASTER-OK", good, True),
            ("PART-1", good, False),
            ("MASTER-NOK", good, True),
            ("PART-2", good, False),
            ("MASTER-NOK", bad, True),
            ("PART-3", good, False),
        ):
            station.feed.show(image)
            answer = await line.inspect(serial, WINDOW_S, golden=golden)
            seen.append((answer.verdict, answer.refused_by))
        await line.close()
        return seen

    seen = asyncio.run(drive())
    masters = [seen[0], seen[2], seen[4]]
    assert [verdict for verdict, _ in masters] == [VerdictCode.TEST] * 3
    assert None not in [refused for _, refused in masters]
    assert seen[1] == (VerdictCode.OK, None)
    assert seen[3] == (VerdictCode.TEST, "OK and NOK are not 1 and 0")
    assert seen[5] == (VerdictCode.OK, None)
    assert [
        (r.purpose is Purpose.GOLDEN, str(r.verdict))
        for e in read_records(station.folder)
        if (r := e.record) is not None
    ] == [
        (True, "OK"),
        (False, "OK"),
        (True, "OK"),
        (False, "OK"),
        (True, "NOK"),
        (False, "OK"),
    ]
    assert station.part_events(6)[-1].record.verdict is Verdict.OK


def test_a_station_that_judges_its_stored_frame_differently_takes_no_parts(
    settings: Settings, frames: dict[str, Image], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    cv2.imwrite(str(tmp_path / "stored.png"), frames[label_with("hole")["frame"]])
    model = settings.model.model_copy(
        update={"self_test_path": tmp_path / "stored.png", "self_test_verdict": "NOK", "self_test_s": 0.5}
    )
    loaded = prepare(settings.model_copy(update={"model": model}), 1)
    self_checks = SelfChecks(loaded, {}, None, 0.0)
    self_checks.run_when_idle()
    assert not self_checks.self_test_failed
    assert loaded.self_test is not None
    loaded.self_test._image[900:1100, :] = 0
    self_checks.run_when_idle()
    assert self_checks.self_test_failed
    assert "self-test failed" in caplog.text
    cv2.imwrite(str(tmp_path / "stored.png"), np.zeros((2160, 4200), np.uint8))
    with pytest.raises(ModelError, match="not NOK"):
        prepare(settings.model_copy(update={"model": model}), 1)


def test_what_cannot_be_judged_is_error_and_the_next_part_goes_on(
    station: Station, frames: dict[str, Image]
) -> None:
    good = frames[label_with("OK")["frame"]]
    black = good * 0
    answers = station.run([None, good[:1000, :2000], black, good])
    assert [a.verdict for a in answers] == [VerdictCode.ERROR] * 3 + [VerdictCode.OK]
    reasons = [Reason.INCOMPLETE_FRAME, Reason.WRONG_SIZE, Reason.NO_WELD_FOUND]
    assert [a.reason for a in answers[:3]] == [r.code for r in reasons]
    assert all(a.handshake_complete for a in answers)
    assert [r.verdict for e in read_records(station.folder) if (r := e.record) is not None] == [
        Verdict.ERROR
    ] * 3 + [Verdict.OK]


@pytest.mark.parametrize("fault", [RecordError("disk full"), RuntimeError("nobody foresaw this")])
def test_a_record_that_cannot_be_written_is_error(
    station: Station, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch, fault: Exception
) -> None:
    def fails(*_arguments: object) -> None:
        raise fault

    monkeypatch.setattr(Archive, "commit", fails)
    (answer,) = station.run([frames[label_with("OK")["frame"]]])
    assert (answer.verdict, answer.reason) == (VerdictCode.ERROR, Reason.RECORD_FAILED.code)
    assert not answer.accepted


def test_a_camera_fault_that_nobody_foresaw_costs_one_part_and_leaves_a_record(
    station: Station, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    good, grab, faults = (
        frames[label_with("OK")["frame"]],
        PylonCamera.grab,
        [ValueError("nobody foresaw this")],
    )

    def fails_once(camera: PylonCamera, trigger_s: float) -> Frame:
        if faults:
            raise faults.pop()
        return grab(camera, trigger_s)

    monkeypatch.setattr(PylonCamera, "grab", fails_once)
    answers = station.run([good, good])
    assert [(a.verdict, a.reason) for a in answers] == [
        (VerdictCode.ERROR, Reason.INTERNAL.code),
        (VerdictCode.OK, 0),
    ]
    assert [r.inspection.reason for e in read_records(station.folder) if (r := e.record) is not None] == [
        Reason.INTERNAL,
        None,
    ]


def test_the_verdict_is_seen_only_after_its_record_is_on_disk(
    station: Station, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    listed: list[int] = []
    publish = ModbusLine.publish

    def look_first(line: ModbusLine, result: object) -> bool:
        listed.append(sum(e.problem is None for e in read_records(station.folder)))
        return publish(line, result)  # type: ignore[arg-type]

    monkeypatch.setattr(ModbusLine, "publish", look_first)
    station.run([frames[label_with("OK")["frame"]]] * 2)
    assert listed == [1, 2]


def test_a_camera_that_is_absent_at_start_is_said_and_found_later(
    station: Station, settings: Settings, frames: dict[str, Image]
) -> None:
    os.environ["PYLON_CAMEMU"] = "0"

    async def absent_then_back() -> Answer:
        line = SimulatedLine.at("127.0.0.1", station.port, accept_simulated=True)
        await line.connect()
        try:
            return await line.inspect("back", WINDOW_S)
        finally:
            await line.close()

    station.feed.show(frames[label_with("OK")["frame"]])
    back = threading.Timer(1.0, lambda: os.environ.update(PYLON_CAMEMU="1"))
    back.start()
    answer = asyncio.run(absent_then_back())
    back.join()
    assert answer.accepted

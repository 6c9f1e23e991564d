"""People at a running station: service mode, setup images, masters, changed settings; the PLC can read it."""

import asyncio
import json
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from deploy.demo.ports import free_ports
from station.archive.reader import find
from station.archive.writer import Archive
from station.camera.pylon import PylonCamera
from station.channel.events import Event, PartEvent, SetupImageEvent, StatusEvent
from station.domain import Frame, Image, Verdict
from station.engine.active_settings import ActiveSettings
from station.engine.alarm_log import AlarmLog
from station.engine.check_ins import IDLE_S, CheckIns
from station.engine.listener import Listener
from station.engine.orders import Order, OrderQueue, Reload, ResetCounts, Service, TestImage
from station.engine.startup import make_camera, make_cycle
from station.inspection.loading import prepare
from station.journal.journal import Kind, entries
from station.plc.line import make_line
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Control, Flags, Offline, Status, VerdictCode
from station.plc.simulated.line import Answer, SimulatedLine
from station.plc.wire.modbus import ModbusClient
from station.settings import adjustments
from station.settings.file import load
from synth.camera.feed import Feed
from tests.conftest import MODEL, RING_MODEL, SEEN_MODEL
from tests.parts import label_with


class Running:
    """An engine in threads of this process, by a settings file."""

    def __init__(self, path: Path, feed: Feed) -> None:
        self.path, self.feed, self.settings = path, feed, load(path)
        self.events: list[Event] = []
        self._orders = OrderQueue()
        self._archive, self._line = Archive(self.settings.archive), make_line(self.settings.plc)
        self._alarm_log, self._stop = AlarmLog(self.settings.archive.folder), threading.Event()
        listener = Listener(self.events.append, lambda _: None, self._orders.take)
        loaded = prepare(self.settings, 1)
        cycle = make_cycle(
            self.settings,
            loaded,
            line=self._line,
            archive=self._archive,
            listener=listener,
            alarm_log=self._alarm_log,
            active=ActiveSettings(self.settings, lambda: load(path), make_camera),
        )
        self._line.start()
        self._thread = threading.Thread(target=cycle.run, args=(self._stop,))
        self._thread.start()

    def ask(self, order: Order) -> None:
        self._orders.put(order)

    def adjust(self, changes: dict[str, object]) -> None:
        """Change the settings file as if by hand."""
        adjustments.path_of(self.path).write_text(json.dumps(changes))

    def until(self, said: Callable[[StatusEvent], bool], again: Order | None = None) -> StatusEvent:
        """Return the first status that meets a condition; repeat an order until then."""
        end, start = time.monotonic() + 200, len(self.events)
        while time.monotonic() < end:
            for event in self.events[start:]:
                if isinstance(event, StatusEvent) and said(event):
                    return event
            if again is not None:
                self.ask(again)
            time.sleep(0.1)
        raise AssertionError("the status never came")

    def part(self, serial: str, image: Image, golden: bool = False) -> Answer:
        """Pass one part."""

        async def drive() -> Answer:
            line = SimulatedLine.at("127.0.0.1", self._line.port, accept_simulated=True)
            await line.connect()
            self.feed.show(image)
            try:
                return await line.inspect(serial, 12.0, golden=golden)
            finally:
                await line.close()

        return asyncio.run(drive())

    def close(self) -> None:
        self._stop.set()
        self._thread.join(timeout=100)
        self._line.stop()
        self._alarm_log.close()
        self._archive.close()


@pytest.fixture
def running(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Running]:
    feed = Feed(tmp_path / "feed")
    for name, value in feed.environment.items():
        monkeypatch.setenv(name, value)
    path = tmp_path / "station.toml"
    path.write_text(f"""
[camera]
kind = "pylon"
device_class = "BaslerCamEmu"
serial = "0815-0000"
reconnect_s = 0.1
timeout_ms = 4000
[model]
path = "{MODEL}"
ring_path = "{RING_MODEL}"
seen_path = "{SEEN_MODEL}"
[archive]
folder = "records"
min_free_mb = 1
thin_free_mb = 1
warn_free_mb = 1
[plc]
port = {free_ports(1)[0]}
deadline_ms = 8000
plc_heartbeat_ms = 0
[golden]
due_h = 24
[golden.masters]
"MASTER-OK" = "OK"
""")
    station = Running(path, feed)
    yield station
    station.close()


def enable(running: Running) -> None:
    running.until(lambda e: e.camera_there)


def test_service_mode_holds_ready_at_0_tells_the_plc_and_ends_with_its_lease(
    running: Running, frames: dict[str, Image]
) -> None:
    good = frames[label_with("OK")["frame"]]
    assert running.part("ONE", good).verdict is VerdictCode.OK
    service = Service("Ada", bit=int(Status.NOK))

    async def drive() -> tuple[dict[str, object], dict[str, object], bool]:
        line = SimulatedLine.at("127.0.0.1", running._line.port, accept_simulated=True)
        await line.connect()

        async def keep() -> None:
            for _ in range(15):
                running.ask(service)
                await asyncio.sleep(0.1)

        await line.meanwhile(keep())
        during = dict(line.status())
        running.ask(replace(service, bit=0))
        await line.meanwhile(asyncio.sleep(0.6))
        without = dict(line.status())
        ready = await line.wait_ready(100.0)  # nobody renews the lease
        await line.close()
        return during, without, ready

    during, without, ready = asyncio.run(drive())
    assert (during["STATUS"], during["MODE"], during["OFFLINE_REASON"]) == (
        int(Status.NOK),
        3,
        int(Offline.SERVICE),
    )
    assert not int(str(without["STATUS"])) & (Status.READY | Status.NOK | Status.RESULT_VALID)
    assert ready
    assert running.part("TWO", good).verdict is VerdictCode.OK


def test_setting_up_pictures_have_numbers_and_leave_no_record(
    running: Running, frames: dict[str, Image]
) -> None:
    running.feed.show(frames[label_with("OK")["frame"]])
    enable(running)
    running.until(
        lambda _: any(isinstance(e, SetupImageEvent) for e in running.events),
        Service("Ada", setup_images=True, exposure_us=900.0),
    )
    seen = next(e for e in running.events if isinstance(e, SetupImageEvent))
    assert seen.exposure_us == 900.0
    assert seen.ring is not None
    assert sum(seen.histogram) == 2688 * 128
    assert 20 < seen.mean_dn < 200
    assert not find(running.settings.archive.folder)
    running.feed.withdraw()
    running.until(
        lambda _: any(isinstance(e, SetupImageEvent) and e.problem for e in running.events),
        Service("Ada", setup_images=True),
    )


def test_a_master_that_is_due_is_told_and_judged_from_the_window(
    running: Running, frames: dict[str, Image]
) -> None:
    status = running.until(lambda e: e.camera_there)
    assert Alarm.MASTERS_DUE in status.alarms
    running.feed.show(frames[label_with("OK")["frame"]])
    running.ask(TestImage(master="MASTER-OK"))
    running.until(lambda e: Alarm.MASTERS_DUE not in e.alarms)
    assert [(row.purpose, row.serial, row.verdict) for row in find(running.settings.archive.folder)] == [
        ("golden", "MASTER-OK", "OK")
    ]
    folder, over = running.settings.archive.folder, f"16#{Alarm.MASTERS_DUE:04X}"
    running.until(
        lambda _: over in [e.subject for e in entries(folder, (Kind.ALARM_OVER,))]
    )  # written by another thread


def test_changed_settings_are_used_at_once_and_refused_ones_are_an_alarm(
    running: Running, frames: dict[str, Image]
) -> None:
    good = frames[label_with("OK")["frame"]]
    before = running.until(lambda e: e.camera_there)
    running.adjust(
        {"recipes": {"1": {"model": {"hole_threshold": 0.0001}}}, "camera": {"exposure_us": 1500.0}}
    )
    running.ask(Reload())
    running.until(lambda e: e.camera_there and e.config_crc != before.config_crc)
    assert running.part("STRICT", good).verdict is VerdictCode.NOK
    running.adjust({"recipes": {"1": {"model": {"hole_threshold": 7}}}})
    running.ask(Reload())
    running.until(lambda e: Alarm.SETTINGS_REFUSED in e.alarms)
    assert running.part("STILL STRICT", good).verdict is VerdictCode.NOK
    running.adjust({})
    running.ask(Reload())
    running.until(lambda e: Alarm.SETTINGS_REFUSED not in e.alarms and e.config_crc == before.config_crc)
    assert running.part("AS BEFORE", good).verdict is VerdictCode.OK


def test_the_time_after_which_a_part_hangs_follows_a_reload(
    running: Running, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A longer time-out of the camera must not look like a cycle that hangs."""
    good, limits_s = frames[label_with("OK")["frame"]], list[float]()

    def noting(self: CheckIns, name: str, within_s: float) -> None:
        if name == "cycle" and within_s != IDLE_S:
            limits_s.append(within_s)

    monkeypatch.setattr(CheckIns, "expect", noting)
    before = running.until(lambda e: e.camera_there)
    assert running.part("ONE", good).verdict is VerdictCode.OK
    running.adjust({"camera": {"timeout_ms": 5500, "exposure_us": 1500.0}})
    running.ask(Reload())
    running.until(lambda e: e.camera_there and e.config_crc != before.config_crc)
    assert running.part("TWO", good).verdict is VerdictCode.OK
    assert limits_s[1] == pytest.approx(limits_s[0] + 2 * (5.5 - 4.0))


def test_a_part_is_never_judged_with_an_exposure_that_was_tried_by_hand(
    running: Running, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    good, used = frames[label_with("OK")["frame"]], []
    grab = PylonCamera.grab

    def noting(camera: PylonCamera, trigger_s: float) -> Frame:
        assert camera._camera is not None
        used.append(camera._camera.ExposureTime.Value)
        return grab(camera, trigger_s)

    monkeypatch.setattr(PylonCamera, "grab", noting)
    running.feed.show(good)
    enable(running)
    wanted = Service("Ada", setup_images=True, exposure_us=900.0)
    running.until(lambda _: any(isinstance(e, SetupImageEvent) for e in running.events), wanted)
    assert used[-1] == 900.0
    looks = len(used)
    assert running.part("AFTER", good).verdict is VerdictCode.OK, "as soon as the lease is over"
    assert used[looks:][-1] == running.settings.camera.exposure_us  # type: ignore[union-attr]


def test_a_result_that_nobody_has_read_is_not_wiped_by_changed_settings(
    running: Running, frames: dict[str, Image]
) -> None:
    running.feed.show(frames[label_with("OK")["frame"]])

    async def drive() -> tuple[list[int], bool]:
        client, beat = ModbusClient("127.0.0.1", running._line.port), 0
        await client.connect()

        async def status() -> int:
            nonlocal beat
            beat += 1
            await client.write(1, [beat])
            return (await client.read(100, 1))[0]

        async def until(bit: Status) -> bool:
            for _ in range(400):
                if await status() & bit:
                    return True
                await asyncio.sleep(0.02)
            return False

        await client.write(0, [int(Control.ENABLE)])
        assert await until(Status.READY)
        await client.write(2, [7])
        await client.write(0, [int(Control.ENABLE | Control.TRIGGER)])
        assert await until(Status.TRIGGER_ACK)
        await client.write(0, [int(Control.ENABLE)])
        assert await until(Status.RESULT_VALID)
        running.ask(Reload())
        seen = []
        for _ in range(50):
            seen.append(await status())
            await asyncio.sleep(0.02)
        await client.write(0, [int(Control.ENABLE | Control.RESULT_ACK)])
        await asyncio.sleep(0.1)
        await client.write(0, [int(Control.ENABLE)])
        ready = await until(Status.READY)
        client.close()
        return seen, ready

    seen, ready = asyncio.run(drive())
    assert all(s & Status.RESULT_VALID and s & Status.OK for s in seen)
    assert not seen[-1] & Status.READY
    assert ready


@pytest.mark.parametrize(
    "change",
    [
        {"camera": {"exposure_us": 0.000001}},
        {"camera": {"serial": "9999"}},
        {"camera": {"device_class": "BaslerGigE"}},
    ],
    ids=["exposure out of range", "another camera", "another kind of camera"],
)
def test_a_camera_that_cannot_be_used_so_is_refused_and_the_one_before_goes_on(
    running: Running, frames: dict[str, Image], change: dict[str, object]
) -> None:
    good = frames[label_with("OK")["frame"]]
    enable(running)
    running.adjust(change)
    running.ask(Reload())
    running.until(lambda e: Alarm.SETTINGS_REFUSED in e.alarms)
    answer = running.part("AS BEFORE", good)
    assert answer.verdict is VerdictCode.OK
    assert Flags.SIMULATED in answer.flags


def test_a_recipe_that_is_not_in_use_must_be_fit_too(running: Running) -> None:
    enable(running)
    running.adjust({"recipes": {"2": {"model": {"path": "nowhere.onnx"}}}})
    running.ask(Reload())
    status = running.until(lambda e: Alarm.SETTINGS_REFUSED in e.alarms)
    assert status.recipe == 1


def test_what_the_window_hears_of_a_part_is_what_the_plc_was_told(
    running: Running, frames: dict[str, Image], monkeypatch: pytest.MonkeyPatch
) -> None:
    def heard(serial: str) -> PartEvent:
        """Return the event of a part; it comes after the result for the PLC."""
        end = time.monotonic() + 100
        while time.monotonic() < end:
            for event in running.events:
                if isinstance(event, PartEvent) and event.record.serial == serial:
                    return event
            time.sleep(0.02)
        raise AssertionError("the event never came")

    good, bad = frames[label_with("OK")["frame"]], frames[label_with("hole")["frame"]]
    assert running.part("GOOD", good).verdict is VerdictCode.OK
    status = running.until(lambda e: e.line.counts.ok == 1)
    assert status.started_s < heard("GOOD").at_s <= time.monotonic()
    assert heard("GOOD").reported is VerdictCode.OK
    assert running.part("MASTER-OK", bad, golden=True).verdict is VerdictCode.TEST
    assert running.part("NOT TRUSTED", good).verdict is VerdictCode.TEST
    assert (heard("NOT TRUSTED").reported, heard("NOT TRUSTED").record.verdict) == (
        VerdictCode.TEST,
        Verdict.OK,
    )
    running.ask(ResetCounts("Ada"))
    running.until(lambda e: e.line.counts.total == 0)

    def broken(*_: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("station.engine.procedure.plc_result", broken)
    assert not running.part("FAULT", good).accepted
    assert (heard("FAULT").reported, heard("FAULT").record.verdict) == (VerdictCode.ERROR, Verdict.ERROR)

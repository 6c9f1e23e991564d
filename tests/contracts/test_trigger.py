"""A frame that was not exposed after the trigger is never given: the emulated camera and the rules alone."""

import time
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from threading import Timer

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pypylon import pylon

from station.camera import pylon as driver
from station.camera.frame_order import FrameOrder, Latch, is_before, is_impossible
from station.camera.pylon import PylonCamera
from station.camera.reconnecting import ReconnectingCamera
from station.defects import Reason
from station.domain import Frame, Image, Origin
from station.errors import CameraLost, FrameTimeout, FrameUnrequested
from station.settings.camera import PylonSettings
from synth.camera.feed import Feed
from tests.contracts.test_camera import EMULATED, picture

ON_LINE = EMULATED.model_copy(update={"trigger": "line1", "timeout_ms": 300})
TICKS_PER_S = 1e9


class OnLine(PylonCamera):
    """The emulated camera with edges on its line, which the test injects."""

    def __init__(self, feed: Feed, settings: PylonSettings = ON_LINE) -> None:
        super().__init__(settings)
        self.feed = feed

    def edge(self, level: int) -> None:
        self.feed.show(picture(level))
        assert self._camera is not None
        # an edge while the camera is not ready would be lost without a word
        assert self._camera.WaitForFrameTriggerReady(1000, pylon.TimeoutHandling_Return)
        self._camera.TriggerSoftware.Execute()

    def edge_soon(self, level: int, after_s: float = 0.12) -> Timer:
        timer = Timer(after_s, self.edge, (level,))
        timer.start()
        return timer


@pytest.fixture
def camera(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[OnLine]:
    feed = Feed(tmp_path / "feed")
    for name, value in feed.environment.items():
        monkeypatch.setenv(name, value)
    made = OnLine(feed)
    made.open()
    yield made
    made.close()


@dataclass
class Clock:
    """A clock for the emulated camera, which has none: `stamps` are the exposures of the next frames."""

    stamps: list[float]
    offset_s: float = 1234.5

    def latched(self, _camera: object) -> Latch:
        now_s = time.monotonic()
        ticks = round((now_s + self.offset_s) * TICKS_PER_S)
        return Latch(ticks=ticks, before_s=now_s, after_s=now_s, ticks_per_s=TICKS_PER_S)

    def stamp(self, _result: object) -> int:
        return round((self.stamps.pop(0) + self.offset_s) * TICKS_PER_S)


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock([])
    monkeypatch.setattr(driver, "latched", made.latched)
    monkeypatch.setattr(driver, "stamp", made.stamp)
    return made


@pytest.mark.parametrize("early_s", [0.0, 0.002, 0.005, 0.01, 0.1])
def test_an_edge_before_the_grab_gives_no_frame(camera: OnLine, early_s: float) -> None:
    camera.edge(10)
    time.sleep(early_s)
    with pytest.raises((FrameTimeout, FrameUnrequested)):
        camera.grab(time.monotonic())


@pytest.mark.parametrize("early_s", [0.0, 0.005, 0.1])
def test_the_edge_after_the_trigger_gives_the_frame_although_one_came_before(
    camera: OnLine, early_s: float
) -> None:
    for level in (10, 60):
        camera.edge(level)
        time.sleep(early_s)
        timer = camera.edge_soon(level + 1)
        frame = camera.grab(time.monotonic())
        timer.join()
        assert frame.image[5, 5] == level + 1


def test_by_its_clock_a_frame_of_an_earlier_exposure_is_dropped_and_counted(
    camera: OnLine, clock: Clock
) -> None:
    camera.edge(10)
    trigger_s = time.monotonic()
    clock.stamps = [trigger_s - 0.003, trigger_s + 0.1, trigger_s + 0.1]
    timer = camera.edge_soon(11)
    frame = camera.grab(trigger_s)
    timer.join()
    assert (frame.image[5, 5], frame.unrequested) == (11, 1)


def test_by_its_clock_a_frame_that_waited_is_taken_if_it_was_exposed_after_the_trigger(
    camera: OnLine, clock: Clock
) -> None:
    """The edge came after BUSY, while the engine was busy with something else."""
    trigger_s = time.monotonic()
    camera.edge(10)
    time.sleep(0.1)
    clock.stamps = [trigger_s + 0.05] * 2
    assert camera.grab(trigger_s).image[5, 5] == 10


def test_by_its_clock_an_earlier_exposure_alone_is_said(camera: OnLine, clock: Clock) -> None:
    camera.edge(10)
    trigger_s = time.monotonic()
    clock.stamps = [trigger_s - 0.001]
    with pytest.raises(FrameUnrequested, match="1 before it"):
        camera.grab(trigger_s)


def test_a_clock_that_was_set_is_said(camera: OnLine, clock: Clock) -> None:
    camera.edge(10)
    trigger_s = time.monotonic()
    clock.stamps = [trigger_s + 3600] * 2
    with pytest.raises(FrameUnrequested, match="future"):
        camera.grab(trigger_s)


def test_a_lost_frame_is_said(camera: OnLine, clock: Clock) -> None:
    trigger_s = time.monotonic() - 1
    clock.stamps = [trigger_s + 0.5] * 4
    camera.edge(10)
    camera.grab(trigger_s)
    camera._order.drop(7)
    camera.edge(11)
    with pytest.raises(FrameUnrequested, match="frame 1 follows frame 7"):
        camera.grab(trigger_s)


def test_a_real_camera_on_the_line_without_a_clock_is_refused(
    camera: OnLine, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(PylonSettings, "origin", Origin.CAMERA)
    with pytest.raises(CameraLost, match=r'its clock cannot be read.*camera\.trigger = "software"'):
        camera.open()


# The rules alone

TIMES_S = st.floats(0, 1e6)
ERRORS = st.floats(-5e-4, 5e-4)


@given(TIMES_S, st.floats(0, 0.05), st.floats(0, 1), st.floats(-2, 2), ERRORS, st.floats(0, 1))
def test_no_exposure_before_the_trigger_passes(
    start_s: float, round_trip_s: float, read: float, exposed_s: float, error: float, trigger_s: float
) -> None:
    """Whatever the offset, the rate within its tolerance and the moment of the reading are."""
    rate = TICKS_PER_S * (1 + error)
    read_s = start_s + read * round_trip_s
    latch = Latch(
        ticks=round(read_s * rate),
        before_s=start_s,
        after_s=start_s + round_trip_s,
        ticks_per_s=TICKS_PER_S,
    )
    stamp = latch.ticks + round((exposed_s - read * round_trip_s) * rate)
    exposure_s = start_s + exposed_s
    margin_s = 1e-6
    if exposure_s < start_s + trigger_s - margin_s:
        assert is_before(stamp, latch, start_s + trigger_s)
    if not is_impossible(stamp, latch, start_s + trigger_s):
        assert exposure_s <= start_s + trigger_s + 2 * round_trip_s + 2 * 2e-3 * 2 + margin_s


@given(st.sampled_from([0, 1]), st.integers(1, 70_000), st.integers(0, 70_000))
def test_numbers_without_a_gap_pass_and_each_other_number_does_not(
    first: int, count: int, other: int
) -> None:
    order, number = FrameOrder(), first
    assert not order.lost(number)
    order._last = number = first + count
    if other != number + 1 and not (number == 0xFFFF and other == 1):
        assert f"frame {other} follows frame {number}" in order.lost(other)
        order._last = number
    assert not order.lost(number + 1)


def test_numbers_wrap_around_are_free_after_damage_and_start_again() -> None:
    order = FrameOrder()
    assert "earlier frames were lost" in order.lost(2)
    order.restart()
    assert not order.lost(1)
    order.drop(0xFFFF)
    assert not order.lost(1)
    order.skip()
    assert not order.lost(9)
    assert order.lost(9)
    order.restart()
    assert not order.lost(0)


# A camera that repeats itself


class Repeating:
    """A camera that gives the images of a list."""

    def __init__(self, images: list[Image], origin: Origin) -> None:
        self.images, self.origin = images, origin

    def open(self) -> None: ...

    def grab(self, trigger_s: float) -> Frame:
        return Frame(self.images.pop(0), datetime.now(UTC), "cam", self.origin, unrequested=2)

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None: ...

    def alive(self) -> bool:
        return True

    def close(self) -> None: ...


def noise(seed: int) -> Image:
    return np.random.default_rng(seed).integers(0, 256, (200, 100), dtype=np.uint8)


def opened(images: list[Image], origin: Origin) -> ReconnectingCamera:
    camera = ReconnectingCamera(Repeating(images, origin), 1.0)
    camera.keep_open()
    return camera


def test_a_real_camera_that_repeats_an_image_is_noticed(caplog: pytest.LogCaptureFixture) -> None:
    almost = noise(1)
    almost[3, 3] ^= 1
    camera = opened([noise(0), noise(1), noise(1).copy(), noise(1).copy(), almost], Origin.CAMERA)
    grabs = [camera.grab() for _ in range(5)]
    assert [grab.reason for grab in grabs] == [None, None, Reason.NOT_OF_TRIGGER, Reason.NOT_OF_TRIGGER, None]
    assert grabs[2].detail is not None
    assert "identical" in grabs[2].detail
    assert "2 frames without a trigger were dropped, 10 since the start" in caplog.text


@pytest.mark.parametrize("origin", [Origin.SIMULATED, Origin.REPLAY])
def test_recorded_and_rendered_images_may_repeat(origin: Origin) -> None:
    camera = opened([noise(0), noise(0)], origin)
    assert [camera.grab().reason for _ in range(2)] == [None, None]


@pytest.mark.parametrize("level", [0, 255])
def test_images_without_light_or_with_too_much_are_left_to_the_quality_gate(level: int) -> None:
    """To restart the camera would not bring the light back."""
    camera = opened([np.full((200, 100), level, np.uint8) for _ in range(2)], Origin.CAMERA)
    assert [camera.grab().reason for _ in range(2)] == [None, None]

"""What every camera must do, run over all of them."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from time import monotonic
from typing import assert_never, get_args

import cv2
import numpy as np
import pytest

from station.camera.choose import make_camera
from station.camera.port import Camera
from station.camera.pylon import PylonCamera
from station.camera.replay import ReplayCamera
from station.domain import Frame, Image, Origin
from station.errors import CameraLost, FrameDamaged, FrameTimeout
from station.settings.camera import AnyCamera, CameraSettings, PylonSettings, ReplaySettings
from synth.camera.feed import Feed

Make = Callable[[list[Image]], Camera]
SMALL = {"width_px": 1280, "height_px": 1040}
EMULATED = PylonSettings(
    kind="pylon", device_class="BaslerCamEmu", serial="0815-0000", timeout_ms=400, **SMALL
)
CAMERAS: dict[str, AnyCamera] = {
    "pylon": EMULATED,
    "replay": ReplaySettings(kind="replay", folder=Path("images")),
}
"""Settings of a camera of each make. A new camera goes here, and gets a branch of `make`."""


def picture(level: int) -> Image:
    image = np.full((1040, 1280), level, np.uint8)
    image[0, 0] = 7
    return image


class Fed(PylonCamera):
    """The production camera with a feed that shows the next image before each grab."""

    def __init__(self, feed: Feed, images: list[Image]) -> None:
        super().__init__(EMULATED)
        self.feed, self.images = feed, images

    def grab(self, trigger_s: float) -> Frame:
        if self.images:
            self.feed.show(self.images.pop(0))
        return super().grab(trigger_s)


@pytest.fixture(params=CAMERAS.values(), ids=CAMERAS)
def settings(request: pytest.FixtureRequest) -> AnyCamera:
    return request.param  # type: ignore[no-any-return]


@pytest.fixture
def make(settings: AnyCamera, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Make]:
    made: list[Camera] = []

    def build(images: list[Image]) -> Camera:
        camera: Camera
        match settings:
            case PylonSettings():
                feed = Feed(tmp_path / "feed")
                for name, value in feed.environment.items():
                    monkeypatch.setenv(name, value)
                camera = Fed(feed, list(images))
            case ReplaySettings():
                folder = tmp_path / settings.folder
                folder.mkdir()
                for index, image in enumerate(images):
                    cv2.imwrite(str(folder / f"{index:03d}.png"), image)
                camera = ReplayCamera(settings.model_copy(update={"folder": folder}))
            case _:
                assert_never(settings)
        made.append(camera)
        return camera

    yield build
    for camera in made:
        camera.close()


def test_every_camera_that_settings_may_name_is_held_to_the_contract() -> None:
    assert {type(settings) for settings in CAMERAS.values()} == set(get_args(AnyCamera))
    assert list(CAMERAS) == [settings.kind for settings in CAMERAS.values()]


def test_the_settings_name_the_camera(settings: AnyCamera, make: Make) -> None:
    assert isinstance(make([]), type(make_camera(settings)))


def test_the_settings_of_a_camera_say_what_it_is_and_what_can_be_set() -> None:
    real = PylonSettings(kind="pylon", serial="1", exposure_us=300, gain_db=2)
    assert real.identity != real.model_copy(update={"serial": "2"}).identity
    assert real.identity == real.model_copy(update={"exposure_us": 400}).identity
    assert real.adjustable == (300, 2)
    recorded = ReplaySettings(kind="replay", folder=Path("a"))
    assert recorded.identity == ("replay",)
    assert recorded.adjustable is None
    # what a new make gets without saying anything: parts count as real, nothing can be set in the window
    assert (EMULATED.origin, recorded.origin) == (Origin.SIMULATED, Origin.REPLAY)
    assert CameraSettings(kind="new").origin is Origin.CAMERA
    assert CameraSettings(kind="new").adjustable is None
    assert CameraSettings(kind="new").size_px is None


def test_the_configuration_of_a_camera_is_written_as_ever() -> None:
    """CONFIG_CRC, which the PLC reads, is made from this text."""
    assert PylonSettings(kind="pylon", serial="1").model_dump_json() == (
        '{"kind":"pylon","device_class":"BaslerGigE","serial":"1","trigger":"software","width_px":4200,"height_px":2160,'
        '"exposure_us":2000.0,"gain_db":0.0,"timeout_ms":500,"reconnect_s":1.0}'
    )
    assert (
        ReplaySettings(kind="replay", folder=Path("a")).model_dump_json()
        == '{"kind":"replay","folder":"a","reconnect_s":1.0}'
    )


def test_each_trigger_gives_the_next_picture_to_the_pixel(settings: AnyCamera, make: Make) -> None:
    images = [picture(level) for level in (10, 200, 90)]
    camera = make(images)
    camera.open()
    for wanted in images:
        frame = camera.grab(monotonic())
        assert (frame.image == wanted).all()
        assert frame.image.dtype == np.uint8
        assert frame.origin is settings.origin
        assert frame.grabbed_at.tzinfo is not None
        assert frame.source


def test_frames_are_their_own(make: Make) -> None:
    camera = make([picture(10), picture(200)])
    camera.open()
    first = camera.grab(monotonic())
    camera.grab(monotonic())
    assert first.image[5, 5] == 10


def test_grab_before_open_is_lost(make: Make) -> None:
    with pytest.raises(CameraLost):
        make([picture(1)]).grab(monotonic())


def test_alive_says_whether_it_can_grab(make: Make) -> None:
    camera = make([picture(1), picture(2)])
    assert not camera.alive()
    camera.open()
    assert camera.alive()


def test_close_twice_and_open_again(make: Make) -> None:
    camera = make([picture(1), picture(2)])
    camera.open()
    camera.grab(monotonic())
    camera.close()
    camera.close()
    camera.open()
    assert camera.grab(monotonic()).image[5, 5] == 2


# What only the emulated camera can show


@pytest.fixture
def fed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Fed]:
    feed = Feed(tmp_path / "feed")
    for name, value in feed.environment.items():
        monkeypatch.setenv(name, value)
    camera = Fed(feed, [])
    yield camera
    camera.close()


def test_a_withdrawn_picture_is_a_damaged_frame_and_the_camera_goes_on(fed: Fed) -> None:
    fed.open()
    fed.feed.show(picture(3))
    fed.grab(monotonic())
    fed.feed.withdraw()
    with pytest.raises(FrameDamaged):
        fed.grab(monotonic())
    fed.feed.show(picture(4))
    assert fed.grab(monotonic()).image[5, 5] == 4


def test_an_incomplete_frame_is_never_given(fed: Fed) -> None:
    fed.open()
    fed.feed.show(picture(3))
    assert fed._camera is not None
    fed._camera.ForceFailedBufferCount.Value = 1
    fed._camera.ForceFailedBuffer.Execute()
    with pytest.raises(FrameDamaged, match="incompletely"):
        fed.grab(monotonic())
    assert fed.grab(monotonic()).image[5, 5] == 3


def test_a_frame_of_another_size_is_never_given(fed: Fed) -> None:
    fed.open()
    fed.feed.show(picture(3)[:1000, :1200])
    with pytest.raises(FrameDamaged, match="1200 x 1000") as caught:
        fed.grab(monotonic())
    assert caught.value.wrong_size


def test_a_transport_error_is_camera_lost_and_open_mends_it(fed: Fed) -> None:
    fed.open()
    fed.feed.show(picture(3))
    assert fed._camera is not None
    fed._camera.StreamGrabber.ImposedError.Value = "cable pulled"
    with pytest.raises(CameraLost, match="cable pulled"):
        fed.grab(monotonic())
    assert not fed.alive()
    fed.open()
    assert fed.grab(monotonic()).image[5, 5] == 3


def test_no_edge_on_the_line_is_a_timeout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in Feed(tmp_path).environment.items():
        monkeypatch.setenv(name, value)
    settings = PylonSettings(
        kind="pylon",
        device_class="BaslerCamEmu",
        serial="0815-0000",
        trigger="line1",
        timeout_ms=100,
        **SMALL,
    )
    camera = PylonCamera(settings)
    camera.open()
    with pytest.raises(FrameTimeout, match="100 ms"):
        camera.grab(monotonic())
    camera.close()


def test_an_absent_camera_is_said_and_comes_back(fed: Fed) -> None:
    os.environ["PYLON_CAMEMU"] = "0"
    with pytest.raises(CameraLost, match="0815-0000"):
        fed.open()
    os.environ["PYLON_CAMEMU"] = "1"
    fed.open()
    fed.feed.show(picture(9))
    assert fed.grab(monotonic()).image[5, 5] == 9


# What only replay can show


def test_an_empty_folder_is_said(tmp_path: Path) -> None:
    with pytest.raises(CameraLost, match="no images in this folder"):
        ReplayCamera(ReplaySettings(kind="replay", folder=tmp_path)).open()


def test_an_unreadable_file_is_a_damaged_frame(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(b"not an image")
    camera = ReplayCamera(ReplaySettings(kind="replay", folder=tmp_path))
    camera.open()
    with pytest.raises(FrameDamaged, match=r"a\.png"):
        camera.grab(monotonic())
    with pytest.raises(CameraLost, match="no more"):
        camera.grab(monotonic())

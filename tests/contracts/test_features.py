"""The features of the camera are those that they must be, whatever somebody left in it."""

import hashlib
import os
from collections.abc import Iterator
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path
from time import monotonic

import pytest
from pypylon import pylon

from station.archive.reader import read_records
from station.archive.writer import Archive
from station.camera import features as table
from station.camera import pylon as driver
from station.camera.features import PLAIN, expected
from station.camera.pylon import PylonCamera
from station.defects import Reason
from station.domain import Inspection
from station.errors import CameraLost
from station.records import Part
from station.settings.camera import PylonSettings
from station.settings.model import ArchiveSettings
from synth.camera.feed import Feed
from tests.contracts.test_camera import EMULATED, picture
from tests.parts import provenance

LEFT_BEHIND = (
    "ReverseX\t1",
    "ReverseY\t1",
    "BinningHorizontal\t2",
    "BinningVertical\t2",
    "Gamma\t2.0000",
    "BlackLevel\t12.000",
    "DigitalShift\t2",
    "PixelFormat\tMono16",
    "OffsetX\t64",
    "OffsetY\t32",
    "AcquisitionFrameRateEnable\t1",
    "AcquisitionMode\tSingleFrame",
    "ExposureAuto\tContinuous",
    "GainAuto\tContinuous",
    "ExposureMode\tTriggerWidth",
    "TriggerActivation\t{TriggerSelector=FrameStart}\tFallingEdge",
    "TriggerDelay\t{TriggerSelector=FrameStart}\t1000.0",
    "TriggerMode\t{TriggerSelector=FrameBurstStart}\tOn",
)
"""What somebody set with the maker's tool."""


@pytest.fixture
def feed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Feed:
    made = Feed(tmp_path / "feed")
    for name, value in made.environment.items():
        monkeypatch.setenv(name, value)
    return made


@pytest.fixture
def camera(feed: Feed) -> Iterator[PylonCamera]:
    made = PylonCamera(EMULATED)
    yield made
    made.close()


def leave(line: str) -> None:
    """Add a value to what the camera has when it is opened."""
    (profile,) = Path(os.environ["PYLON_CAMEMU_PFS_PATH"]).glob("*.pfs")
    profile.write_text(profile.read_text() + line + "\n")


def values(camera: PylonCamera) -> dict[str, object]:
    assert camera._camera is not None
    nodes = camera._camera.GetNodeMap()
    found = {name: nodes.GetNode(name) for name in expected(EMULATED)}
    return {name: node.Value for name, node in found.items() if node.IsReadable()}


@pytest.mark.parametrize("line", [*LEFT_BEHIND, "\n".join(LEFT_BEHIND)], ids=lambda line: line.split("\t")[0])
def test_what_was_left_in_the_camera_is_set_right(feed: Feed, camera: PylonCamera, line: str) -> None:
    leave(line)
    camera.open()
    assert values(camera).items() <= expected(EMULATED).items()
    feed.show(picture(40))
    frame = camera.grab(monotonic())
    assert (frame.image == picture(40)).all()
    assert "TriggerMode\t{TriggerSelector=FrameBurstStart}\tOff" in frame.features


def test_the_values_left_behind_are_others(feed: Feed) -> None:
    """Otherwise the test above would show nothing: the emulator takes them when it is opened."""
    for line in LEFT_BEHIND:
        leave(line)
    info = pylon.DeviceInfo()
    info.SetDeviceClass("BaslerCamEmu")
    device = pylon.InstantCamera(pylon.TlFactory.GetInstance().CreateFirstDevice(info))
    device.Open()
    text = str(pylon.FeaturePersistence.SaveToString(device.GetNodeMap()))
    device.DestroyDevice()
    taken = [line for line in LEFT_BEHIND if line in text.splitlines()]
    assert len(taken) >= len(LEFT_BEHIND) - 2, set(LEFT_BEHIND) - set(taken)


def test_a_value_that_cannot_be_set_is_refused(camera: PylonCamera, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PLAIN, "DeviceModelName", "another")
    with pytest.raises(CameraLost, match=r"0815-0000.*DeviceModelName is CamEmu, must be another"):
        camera.open()
    assert not camera.alive()


def test_a_needed_feature_that_is_absent_is_refused(
    camera: PylonCamera, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(PLAIN, "Shutter", "Global")
    camera.open()
    monkeypatch.setattr(driver, "NEEDED", (*table.NEEDED, "Shutter"))
    with pytest.raises(CameraLost, match="has no feature Shutter"):
        camera.open()


def test_a_region_that_does_not_fit_is_refused(feed: Feed) -> None:
    camera = PylonCamera(EMULATED.model_copy(update={"width_px": 40_000}))
    with pytest.raises(CameraLost, match="0815-0000"):
        camera.open()


def test_numbers_are_equal_within_the_steps_of_a_camera() -> None:
    assert not table.differs(300.1, 300.0)
    assert table.differs(303.0, 300.0)
    assert table.differs(0.01, 0.0)
    assert table.differs("On", "Off")
    assert not table.differs(False, 0)


def test_each_record_names_the_features_of_the_camera(
    feed: Feed, camera: PylonCamera, tmp_path: Path
) -> None:
    feed.show(picture(40))
    camera.open()
    folder = tmp_path / "records"
    with closing(Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1))) as archive:
        for exposure_us in (EMULATED.exposure_us, 300.0):
            camera = PylonCamera(EMULATED.model_copy(update={"exposure_us": exposure_us}))
            camera.open()
            for _ in range(2):
                pending = archive.begin(camera.grab(monotonic()))
                part = Part("A", 1, EMULATED.origin)
                now = datetime.now(UTC)
                archive.commit(pending, Inspection.error(Reason.BLURRED), part, provenance(), now=now)
            camera.close()
    names = [entry.record.camera_sha256 for entry in read_records(folder) if entry.record is not None]
    assert len(names) == 4
    assert len(set(names)) == 2
    for name in names:
        text = (folder / "cameras" / f"{name}.txt").read_bytes()
        assert hashlib.sha256(text).hexdigest() == name
        assert b"Gamma\t1.0" in text


def test_the_settings_say_that_a_camera_is_emulated() -> None:
    assert EMULATED.is_emulated
    assert "TestImageSelector" not in expected(EMULATED)
    assert expected(PylonSettings(kind="pylon", serial="1"))["TestImageSelector"] == "Off"

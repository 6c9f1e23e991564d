"""The section [camera]: one class per make of camera; `make_camera` makes the camera from it."""

from typing import Literal

from pydantic import Field

from station.domain import Origin
from station.settings.section import FilePath, Section


class CameraSettings(Section):
    """Settings that every make of camera provides to the station.

    The order of the keys affects CONFIG_CRC: add new ones at the end.
    """

    kind: str

    @property
    def origin(self) -> Origin:
        """Source of the frames; only frames from a real camera can release a part."""
        return Origin.CAMERA

    @property
    def identity(self) -> tuple[str, ...]:
        """Values that identify the device; they cannot be changed while the station runs."""
        return (self.kind,)

    @property
    def size_px(self) -> tuple[int, int] | None:
        """Width and height of the images; None if only the images themselves show them."""
        return None

    @property
    def grab_s(self) -> float:
        """Longest time that a grab takes if the camera works."""
        return 0.0

    @property
    def adjustable(self) -> tuple[float, float] | None:
        """Exposure in µs and gain in dB if `exposure_us` and `gain_db` can be adjusted, else None."""
        return None


class PylonSettings(CameraSettings):
    """Settings of a Basler camera, real or emulated, that pypylon drives."""

    kind: Literal["pylon"]
    device_class: Literal["BaslerGigE", "BaslerCamEmu"] = "BaslerGigE"
    serial: str = Field(min_length=1)
    trigger: Literal["software", "line1"] = "software"
    width_px: int = Field(default=4200, ge=1)
    height_px: int = Field(default=2160, ge=1)
    exposure_us: float = Field(default=2000.0, gt=0, le=1_000_000)
    gain_db: float = Field(default=0.0, ge=0, le=48)
    timeout_ms: int = Field(default=500, ge=10, le=60_000)
    reconnect_s: float = Field(default=1.0, ge=0.05, le=60)

    @property
    def origin(self) -> Origin:
        """Source of the frames; parts of an emulated camera carry the SIMULATED flag."""
        return Origin.SIMULATED if self.is_emulated else Origin.CAMERA

    @property
    def is_emulated(self) -> bool:
        """True if pylon emulates the camera."""
        return self.device_class == "BaslerCamEmu"

    @property
    def identity(self) -> tuple[str, ...]:
        """Make, device class and serial number."""
        return self.kind, self.device_class, self.serial

    @property
    def size_px(self) -> tuple[int, int] | None:
        """Width and height of the images."""
        return self.width_px, self.height_px

    @property
    def grab_s(self) -> float:
        """Longest time that a grab takes: until the camera is ready, and until the frame comes."""
        return 2 * self.timeout_ms / 1000

    @property
    def adjustable(self) -> tuple[float, float] | None:
        """Exposure in µs and gain in dB."""
        return self.exposure_us, self.gain_db


class ReplaySettings(CameraSettings):
    """Settings of a folder of recorded images, which are used once each in the order of their names."""

    kind: Literal["replay"]
    folder: FilePath
    reconnect_s: float = Field(default=1.0, ge=0.05, le=60)

    @property
    def origin(self) -> Origin:
        """Source of the frames; the PLC reads the verdict TEST for replayed parts."""
        return Origin.REPLAY


AnyCamera = PylonSettings | ReplaySettings
"""Settings of a camera of any make; `camera.kind` selects the make."""

"""The section [camera]: one class for each make; `make_camera` makes the camera that it describes."""

from pathlib import Path
from typing import Literal

from pydantic import Field

from station.domain import Origin
from station.settings.section import Section


class CameraSettings(Section):
    """What the station asks of every camera's settings, whatever the make.

    The order of the keys counts: CONFIG_CRC is made from it. Add new ones at the end.
    """

    kind: str

    @property
    def origin(self) -> Origin:
        """Where the frames come from; only a real camera's parts may be released."""
        return Origin.CAMERA

    @property
    def identity(self) -> tuple[str, ...]:
        """Which device it is: another one is refused while the station runs."""
        return (self.kind,)

    @property
    def adjustable(self) -> tuple[float, float] | None:
        """Exposure in µs and gain in dB, where people may set `exposure_us` and `gain_db`; None if there are none."""
        return None


class PylonSettings(CameraSettings):
    """A Basler camera, real or emulated, through pypylon."""

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
        """Where the frames come from: an emulated camera's parts carry the SIMULATED flag."""
        return Origin.SIMULATED if self.device_class == "BaslerCamEmu" else Origin.CAMERA

    @property
    def identity(self) -> tuple[str, ...]:
        """Make, class and serial number."""
        return self.kind, self.device_class, self.serial

    @property
    def adjustable(self) -> tuple[float, float] | None:
        """Exposure in µs and gain in dB."""
        return self.exposure_us, self.gain_db


class ReplaySettings(CameraSettings):
    """Recorded images from a folder, in the order of their names, once each."""

    kind: Literal["replay"]
    folder: Path
    reconnect_s: float = Field(default=1.0, ge=0.05, le=60)

    @property
    def origin(self) -> Origin:
        """Where the frames come from: to the PLC, replayed parts read TEST."""
        return Origin.REPLAY


AnyCamera = PylonSettings | ReplaySettings
"""Settings of any camera: `camera.kind` says of which."""

"""What the cycle needs of a camera, independent of the make."""

from typing import Protocol

from station.domain import Frame


class Camera(Protocol):
    """A camera that gives one frame per trigger; after a loss it must be opened again."""

    def open(self) -> None:
        """Connect and configure, also after a loss. Raises CameraLost."""

    def grab(self, trigger_s: float) -> Frame:
        """Return one frame of the part in view, whose exposure began after `trigger_s` (monotonic time).

        Raises FrameTimeout, FrameDamaged, FrameUnrequested (the camera stays open) or CameraLost (open it
        again).
        """

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """Set exposure and gain until the camera is opened again; None: as in the settings.

        Recorded images are not affected. Raises CameraLost.
        """

    def alive(self) -> bool:
        """Return whether the open camera still answers; cheap enough for idle times."""

    def close(self) -> None:
        """Release the device; does nothing if it is not open."""

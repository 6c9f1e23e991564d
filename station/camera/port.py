"""What the cycle needs of a camera, whatever the make."""

from typing import Protocol

from station.domain import Frame


class Camera(Protocol):
    """A camera that gives one frame a trigger. Lost once, it must be opened again."""

    def open(self) -> None:
        """Connect and configure; again after a loss. Raises CameraLost saying what is absent."""

    def grab(self) -> Frame:
        """One frame of the part in view.

        Raises FrameTimeout, FrameDamaged (the camera stays open) or CameraLost (open it again).
        """

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """For the next frames, until it is opened again; None: as the settings say. Recorded pictures stay as they are.

        Raises CameraLost.
        """

    def alive(self) -> bool:
        """Whether the open camera still answers; cheap, for idle times."""

    def close(self) -> None:
        """Let go of the device; harmless if it is not open."""

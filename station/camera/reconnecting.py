"""A camera that is opened again after a loss; every grab gives a frame or the reason why there is none."""

import logging
import time
from dataclasses import dataclass, field

import numpy as np

from station.camera.port import Camera
from station.defects import Reason
from station.domain import Frame, Image, Origin
from station.errors import CameraLost, FrameDamaged, FrameTimeout, FrameUnrequested

log = logging.getLogger("weldgate.camera")

SAMPLED_ROWS = 64
"""One row of this many is compared first, to see fast that two images differ."""
ALIVE_S = 1.0
"""Time between two checks whether the camera still answers."""


@dataclass(frozen=True, slots=True, eq=False)
class Grab:
    """One attempt to take a frame: either the frame, or the reason why there is none."""

    frame: Frame | None
    reason: Reason | None
    grab_ms: float | None
    """Duration of the attempt; None if the camera was not asked."""
    detail: str | None = field(default=None, kw_only=True)
    """One line on why there is no frame; None if the reason says it all."""

    def __post_init__(self) -> None:
        if (self.frame is None) == (self.reason is None):
            raise ValueError("a grab has a frame or the reason why there is none")


class ReconnectingCamera:
    """A camera that is kept open. Use from one thread."""

    def __init__(self, camera: Camera, reconnect_s: float) -> None:
        """`reconnect_s`: time between two attempts to open it."""
        self._camera, self._reconnect_s = camera, reconnect_s
        self._tried_s = self._alive_s = -1e9
        self._adjusted: tuple[float | None, float | None] | None = None
        """Exposure and gain set by hand; None: those of the settings."""
        self._previous: Image | None = None
        """Last image of a real camera, whose noise never repeats."""
        self._unrequested = 0
        """Number of frames that no trigger had asked for, since the start."""
        self.connected = False
        self.message = "the camera is not opened yet"
        """Reason why the camera is not connected; empty if it is."""

    def keep_open(self) -> None:
        """Open the camera if it is time; check now and then whether it still answers."""
        now_s = time.monotonic()
        if self.connected and now_s - self._alive_s >= ALIVE_S:
            self._alive_s = now_s
            if not self._camera.alive():
                self._lost("the camera stopped answering")
        if not self.connected and now_s - self._tried_s >= self._reconnect_s:
            try:
                self._camera.open()
            except CameraLost as error:
                self._lost(str(error))
            else:
                log.info("camera opened")
                self.connected, self.message, self._alive_s = True, "", now_s
            self._tried_s = time.monotonic()

    def grab(self, trigger_s: float | None = None) -> Grab:
        """Take a frame exposed after `trigger_s` (monotonic; None: now).

        A lost or failing camera gives a reason, not an exception.
        """
        start = time.perf_counter()
        frame, reason, detail = None, None, None
        if not self.connected:
            reason = Reason.CAMERA_LOST
        else:
            try:
                frame = self._checked(self._camera.grab(time.monotonic() if trigger_s is None else trigger_s))
            except FrameTimeout as error:
                log.warning("%s", error)
                reason = Reason.NO_FRAME
            except FrameDamaged as error:
                log.warning("%s", error)
                reason = Reason.WRONG_SIZE if error.wrong_size else Reason.INCOMPLETE_FRAME
            except FrameUnrequested as error:
                log.error("%s", error)
                reason, detail = Reason.NOT_OF_TRIGGER, str(error)
            except CameraLost as error:
                self._lost(str(error))
                reason = Reason.CAMERA_LOST
            except Exception:  # the part needs its record: any fault means "no image"
                log.exception("the camera failed with an error")
                self._lost("the camera failed with an error: see the log")
                reason = Reason.INTERNAL
        return Grab(frame, reason, (time.perf_counter() - start) * 1000, detail=detail)

    def _checked(self, frame: Frame) -> Frame:
        """Return the frame. Raises FrameUnrequested if a real camera repeats an image."""
        if frame.unrequested:
            self._unrequested += frame.unrequested
            log.warning(
                "camera: %d frames without a trigger were dropped, %d since the start; check trigger line",
                frame.unrequested,
                self._unrequested,
            )
        if frame.origin is Origin.CAMERA:
            previous, self._previous = self._previous, frame.image
            if previous is not None and _same(previous, frame.image):
                raise FrameUnrequested(
                    f"camera {frame.source}: two images in succession are identical, which no sensor gives; "
                    "restart the camera"
                )
        return frame

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """Set exposure and gain for the next frames; None: as in the settings."""
        adjusted = None if exposure_us is None and gain_db is None else (exposure_us, gain_db)
        if not self.connected or adjusted == self._adjusted:
            return
        try:
            self._camera.adjust(exposure_us, gain_db)
            self._adjusted = adjusted
        except CameraLost as error:
            self._lost(str(error))
        except Exception:  # it is opened again with the settings
            log.exception("the camera failed with an error")
            self._lost("the camera failed with an error: see the log")

    def replace(self, camera: Camera) -> bool:
        """Use another camera instead, as its settings have changed.

        Returns False if it cannot be opened; then the previous one stays.
        """
        self._camera.close()
        try:
            camera.open()
        except CameraLost as error:
            log.error("%s", error)
            camera.close()
            self._tried_s = -1e9
            self._lost("the camera is opened again with the previous settings")
            return False
        self._camera, self._adjusted = camera, None
        self.connected, self.message, self._alive_s = True, "", time.monotonic()
        return True

    def _lost(self, message: str) -> None:
        if message != self.message:
            log.warning("%s", message)
        self.connected, self.message, self._adjusted = False, message, None

    def close(self) -> None:
        """Release the device."""
        self._camera.close()


def _same(first: Image, second: Image) -> bool:
    """Return whether two images are identical and show anything: without light all are alike."""
    sampled = np.array_equal(first[::SAMPLED_ROWS], second[::SAMPLED_ROWS])
    return sampled and np.array_equal(first, second) and bool(second.min() != second.max())

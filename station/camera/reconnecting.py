"""A camera that is opened, watched while idle and opened again after a loss; every grab ends in a frame or a reason."""

import logging
import time
from dataclasses import dataclass

from station.camera.port import Camera
from station.defects import Reason
from station.domain import Frame
from station.errors import CameraLost, FrameDamaged, FrameTimeout

log = logging.getLogger("weldgate.camera")

ALIVE_S = 1.0
"""Between two questions whether it still answers."""


@dataclass(frozen=True, slots=True, eq=False)
class Grab:
    """One attempt to take a frame: either the frame, or the reason why there is none."""

    frame: Frame | None
    reason: Reason | None
    grab_ms: float | None
    """Duration of the attempt; None if the camera was not asked."""

    def __post_init__(self) -> None:
        if (self.frame is None) == (self.reason is None):
            raise ValueError("a grab has a frame or the reason why there is none")


class ReconnectingCamera:
    """Use from one thread."""

    def __init__(self, camera: Camera, reconnect_s: float) -> None:
        """`reconnect_s`: pause between two attempts to open it."""
        self._camera, self._reconnect_s = camera, reconnect_s
        self._tried_s = self._alive_s = -1e9
        self._adjusted: tuple[float | None, float | None] | None = None
        """Exposure and gain set by hand."""
        self.there = False
        self.message = "camera not opened yet"
        """Why it is not there; empty if it is."""

    def look_after(self) -> None:
        """Open it if it is time to; ask it, while idle, whether it still answers."""
        now = time.monotonic()
        if self.there and now - self._alive_s >= ALIVE_S:
            self._alive_s = now
            if not self._camera.alive():
                self._lost("camera stopped answering")
        if not self.there and now - self._tried_s >= self._reconnect_s:
            try:
                self._camera.open()
            except CameraLost as error:
                self._lost(str(error))
            else:
                log.info("camera opened")
                self.there, self.message, self._alive_s = True, "", now
            self._tried_s = time.monotonic()

    def grab(self) -> Grab:
        """Take a frame; a camera that is lost or fails is a reason, not an exception."""
        start = time.perf_counter()
        frame, reason = None, None
        if not self.there:
            reason = Reason.CAMERA_LOST
        else:
            try:
                frame = self._camera.grab()
            except FrameTimeout as error:
                log.warning("%s", error)
                reason = Reason.NO_FRAME
            except FrameDamaged as error:
                log.warning("%s", error)
                reason = Reason.WRONG_SIZE if error.wrong_size else Reason.INCOMPLETE_FRAME
            except CameraLost as error:
                self._lost(str(error))
                reason = Reason.CAMERA_LOST
            except Exception:  # the part must get its record: any fault is "no picture"
                log.exception("the camera ended with a fault")
                self._lost("camera ended with a fault, see the log")
                reason = Reason.INTERNAL
        return Grab(frame, reason, (time.perf_counter() - start) * 1000)

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """For the next frames; None: as the settings say."""
        wanted = None if exposure_us is None and gain_db is None else (exposure_us, gain_db)
        if not self.there or wanted == self._adjusted:
            return
        try:
            self._camera.adjust(exposure_us, gain_db)
            self._adjusted = wanted
        except CameraLost as error:
            self._lost(str(error))
        except Exception:  # it is opened again, as the settings say
            log.exception("the camera ended with a fault")
            self._lost("camera ended with a fault, see the log")

    def exchange(self, camera: Camera) -> bool:
        """Another one in its place: its settings have changed. False if it cannot be opened so; then the old one stays."""
        self._camera.close()
        try:
            camera.open()
        except CameraLost as error:
            log.error("%s", error)
            camera.close()
            self._tried_s = -1e9
            self._lost("camera is opened again with the settings before")
            return False
        self._camera, self._adjusted = camera, None
        self.there, self.message, self._alive_s = True, "", time.monotonic()
        return True

    def _lost(self, message: str) -> None:
        if message != self.message:
            log.warning("%s", message)
        self.there, self.message, self._adjusted = False, message, None

    def close(self) -> None:
        """Let go of the device."""
        self._camera.close()

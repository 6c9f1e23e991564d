"""A camera that is opened again after a loss; every grab gives a frame or the reason why there is none."""

import logging
import time
from dataclasses import dataclass

from station.camera.port import Camera
from station.defects import Reason
from station.domain import Frame
from station.errors import CameraLost, FrameDamaged, FrameTimeout

log = logging.getLogger("weldgate.camera")

ALIVE_S = 1.0
"""Time between two checks whether the camera still answers."""


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
    """A camera that is kept open. Use from one thread."""

    def __init__(self, camera: Camera, reconnect_s: float) -> None:
        """`reconnect_s`: time between two attempts to open it."""
        self._camera, self._reconnect_s = camera, reconnect_s
        self._tried_s = self._alive_s = -1e9
        self._adjusted: tuple[float | None, float | None] | None = None
        """Exposure and gain set by hand; None: those of the settings."""
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

    def grab(self) -> Grab:
        """Take a frame; a lost or failing camera gives a reason, not an exception."""
        start = time.perf_counter()
        frame, reason = None, None
        if not self.connected:
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
            except Exception:  # the part needs its record: any fault means "no image"
                log.exception("the camera failed with an error")
                self._lost("the camera failed with an error: see the log")
                reason = Reason.INTERNAL
        return Grab(frame, reason, (time.perf_counter() - start) * 1000)

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

"""Basler cameras, real or emulated; the only file that imports pypylon."""

from datetime import UTC, datetime

import numpy as np
from pypylon import genicam, pylon

from station.domain import Frame
from station.errors import CameraLost, FrameDamaged, FrameTimeout
from station.settings.camera import PylonSettings

SOURCES = {"software": "Software", "line1": "Line1"}
"""GenICam name of each trigger source."""


class PylonCamera:
    """A Basler camera, found by device class and serial: a wider search would query all interfaces."""

    def __init__(self, settings: PylonSettings) -> None:
        self._settings = settings
        self._camera: pylon.InstantCamera | None = None

    def open(self) -> None:
        """Connect and configure, also after a loss. Raises CameraLost."""
        self.close()
        settings = self._settings
        info = pylon.DeviceInfo()
        info.SetDeviceClass(settings.device_class)
        info.SetSerialNumber(settings.serial)
        camera = None
        try:
            camera = pylon.InstantCamera(pylon.TlFactory.GetInstance().CreateFirstDevice(info))
            camera.Open()
            _configure(camera, settings)
            camera.StartGrabbing(pylon.GrabStrategy_OneByOne)
        except genicam.GenericException as error:
            if camera is not None:
                _release(camera)
            name = f"camera {settings.serial} ({settings.device_class})"
            raise CameraLost(f"{name}: {_first_line(error)}; check power, cable and camera.serial") from None
        self._camera = camera

    def grab(self) -> Frame:
        """Return one frame, by software trigger or the next hardware edge; earlier frames are dropped.

        Raises CameraLost, FrameTimeout, FrameDamaged.
        """
        camera, settings = self._camera, self._settings
        if camera is None:
            raise CameraLost(f"camera {settings.serial} is not open")
        try:
            while camera.GetGrabResultWaitObject().Wait(0):
                camera.RetrieveResult(0, pylon.TimeoutHandling_Return).Release()
            if settings.trigger == "software":
                if not camera.WaitForFrameTriggerReady(settings.timeout_ms, pylon.TimeoutHandling_Return):
                    raise FrameTimeout(
                        f"camera {settings.serial}: not ready for a trigger within {settings.timeout_ms} ms"
                    )
                camera.ExecuteSoftwareTrigger()
            result = camera.RetrieveResult(settings.timeout_ms, pylon.TimeoutHandling_Return)
            with result:
                return self._frame(camera, result)
        except genicam.GenericException as error:
            self.close()
            raise CameraLost(f"camera {settings.serial}: {_first_line(error)}") from None

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """Set exposure and gain within the camera's range; None: as in the settings. Raises CameraLost."""
        settings = self._settings
        if self._camera is None:
            raise CameraLost(f"camera {settings.serial} is not open")
        try:
            for node, value in (
                (self._camera.ExposureTime, settings.exposure_us if exposure_us is None else exposure_us),
                (self._camera.Gain, settings.gain_db if gain_db is None else gain_db),
            ):
                node.Value = min(max(value, node.Min), node.Max)
        except genicam.GenericException as error:
            self.close()
            raise CameraLost(f"camera {settings.serial}: {_first_line(error)}") from None

    def alive(self) -> bool:
        """Return whether the device is connected, grabs, and answers the read of a node."""
        camera = self._camera
        if camera is None:
            return False
        try:
            connected = not camera.IsCameraDeviceRemoved() and camera.IsGrabbing()
            return bool(connected and camera.Width.Value == self._settings.width_px)
        except genicam.GenericException:
            return False

    def close(self) -> None:
        """Destroy the device object: a lost one must never be used again."""
        if self._camera is not None:
            _release(self._camera)
            self._camera = None

    def _frame(self, camera: pylon.InstantCamera, result: pylon.GrabResult) -> Frame:
        settings = self._settings
        name = f"camera {settings.serial}"
        if not result.IsValid():
            if not camera.IsGrabbing() or camera.IsCameraDeviceRemoved():
                self.close()
                raise CameraLost(f"{name}: stopped grabbing")
            _flush(camera)
            raise FrameTimeout(f"{name}: no frame within {settings.timeout_ms} ms")
        if not result.GrabSucceeded():
            raise FrameDamaged(
                f"{name}: frame incomplete ({result.GetErrorDescription() or 'no description'})"
            )
        if (result.Width, result.Height) != (settings.width_px, settings.height_px):
            expected = f"{settings.width_px} x {settings.height_px}"
            size = f"{result.Width} x {result.Height} px instead of {expected} px"
            raise FrameDamaged(f"{name}: frame is {size}", wrong_size=True)
        if result.GetPixelType() != pylon.PixelType_Mono8:
            raise FrameDamaged(f"{name}: frame is not Mono8")
        return Frame(np.array(result.Array, np.uint8), datetime.now(UTC), settings.serial, settings.origin)


def _configure(camera: pylon.InstantCamera, settings: PylonSettings) -> None:
    """Set all features; emulator and ace 2 use the same names."""
    for node, value in ((camera.WidthMax, settings.width_px), (camera.HeightMax, settings.height_px)):
        if genicam.IsWritable(node) and node.Value < value:
            node.Value = value
    camera.PixelFormat.Value = "Mono8"
    camera.Width.Value = settings.width_px
    camera.Height.Value = settings.height_px
    camera.ExposureAuto.TrySetValue("Off")
    camera.GainAuto.TrySetValue("Off")
    camera.ExposureTime.Value = settings.exposure_us
    camera.Gain.Value = settings.gain_db
    camera.TriggerSelector.Value = "FrameStart"
    camera.TriggerMode.Value = "On"
    camera.TriggerSource.Value = SOURCES[settings.trigger]
    camera.MaxNumBuffer.Value = 5


def _flush(camera: pylon.InstantCamera) -> None:
    """Discard a frame that comes late, so that it is not taken for that of the next part."""
    camera.StopGrabbing()
    camera.StartGrabbing(pylon.GrabStrategy_OneByOne)


def _release(camera: pylon.InstantCamera) -> None:
    try:
        if camera.IsGrabbing():
            camera.StopGrabbing()
        if camera.IsPylonDeviceAttached():
            camera.DestroyDevice()
    except genicam.GenericException:
        return


def _first_line(error: BaseException) -> str:
    return (
        str(error).strip().splitlines()[0].split(" : ")[0][:160]
        if str(error).strip()
        else type(error).__name__
    )

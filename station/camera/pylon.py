"""Basler cameras through pypylon, real or emulated; the only file that imports it."""

from datetime import UTC, datetime

import numpy as np
from pypylon import genicam, pylon

from station.domain import Frame
from station.errors import CameraLost, FrameDamaged, FrameTimeout
from station.settings.camera import PylonSettings

SOURCES = {"software": "Software", "line1": "Line1"}


class PylonCamera:
    """One camera, found by device class and serial: an unfiltered search would ask every network interface."""

    def __init__(self, settings: PylonSettings) -> None:
        self._settings = settings
        self._camera: pylon.InstantCamera | None = None

    def open(self) -> None:
        """Connect and configure; again after a loss. Raises CameraLost."""
        self.close()
        s = self._settings
        wanted = pylon.DeviceInfo()
        wanted.SetDeviceClass(s.device_class)
        wanted.SetSerialNumber(s.serial)
        camera = None
        try:
            camera = pylon.InstantCamera(pylon.TlFactory.GetInstance().CreateFirstDevice(wanted))
            camera.Open()
            _configure(camera, s)
            camera.StartGrabbing(pylon.GrabStrategy_OneByOne)
        except genicam.GenericException as error:
            if camera is not None:
                _release(camera)
            raise CameraLost(
                f"camera {s.serial} ({s.device_class}): {_first_line(error)}; check power, cable and camera.serial"
            ) from None
        self._camera = camera

    def grab(self) -> Frame:
        """One frame, by software trigger or at the next hardware edge; frames from before are dropped."""
        camera, s = self._camera, self._settings
        if camera is None:
            raise CameraLost(f"camera {s.serial} is not open")
        try:
            while camera.GetGrabResultWaitObject().Wait(0):
                camera.RetrieveResult(0, pylon.TimeoutHandling_Return).Release()
            if s.trigger == "software":
                if not camera.WaitForFrameTriggerReady(s.timeout_ms, pylon.TimeoutHandling_Return):
                    raise FrameTimeout(f"camera {s.serial}: not ready for a trigger within {s.timeout_ms} ms")
                camera.ExecuteSoftwareTrigger()
            result = camera.RetrieveResult(s.timeout_ms, pylon.TimeoutHandling_Return)
            with result:
                return self._frame(camera, result)
        except genicam.GenericException as error:
            self.close()
            raise CameraLost(f"camera {s.serial}: {_first_line(error)}") from None

    def adjust(self, exposure_us: float | None, gain_db: float | None) -> None:
        """For the next frames, within what the camera can do; None: as the settings say. Raises CameraLost."""
        s = self._settings
        if self._camera is None:
            raise CameraLost(f"camera {s.serial} is not open")
        try:
            for node, value in (
                (self._camera.ExposureTime, s.exposure_us if exposure_us is None else exposure_us),
                (self._camera.Gain, s.gain_db if gain_db is None else gain_db),
            ):
                node.Value = min(max(value, node.Min), node.Max)
        except genicam.GenericException as error:
            self.close()
            raise CameraLost(f"camera {s.serial}: {_first_line(error)}") from None

    def alive(self) -> bool:
        """Whether the device is there, grabbing, and answers a read of a node."""
        camera = self._camera
        if camera is None:
            return False
        try:
            there = not camera.IsCameraDeviceRemoved() and camera.IsGrabbing()
            return bool(there and camera.Width.Value == self._settings.width_px)
        except genicam.GenericException:
            return False

    def close(self) -> None:
        """Destroy the device object: a lost one must never be used again."""
        if self._camera is not None:
            _release(self._camera)
            self._camera = None

    def _frame(self, camera: pylon.InstantCamera, result: pylon.GrabResult) -> Frame:
        s = self._settings
        if not result.IsValid():
            if not camera.IsGrabbing() or camera.IsCameraDeviceRemoved():
                self.close()
                raise CameraLost(f"camera {s.serial}: stopped grabbing")
            _flush(camera)
            raise FrameTimeout(f"camera {s.serial}: no frame within {s.timeout_ms} ms")
        if not result.GrabSucceeded():
            raise FrameDamaged(
                f"camera {s.serial}: frame incompletely grabbed ({result.GetErrorDescription() or 'no description'})"
            )
        if (result.Width, result.Height) != (s.width_px, s.height_px):
            size = f"{result.Width} x {result.Height} px, set are {s.width_px} x {s.height_px}"
            raise FrameDamaged(f"camera {s.serial}: frame is {size}", wrong_size=True)
        if result.GetPixelType() != pylon.PixelType_Mono8:
            raise FrameDamaged(f"camera {s.serial}: frame is not Mono8")
        return Frame(np.array(result.Array, np.uint8), datetime.now(UTC), s.serial, s.origin)


def _configure(camera: pylon.InstantCamera, s: PylonSettings) -> None:
    """The one place where features are set; emulator and ace 2 share the names."""
    for node, value in ((camera.WidthMax, s.width_px), (camera.HeightMax, s.height_px)):
        if genicam.IsWritable(node) and node.Value < value:
            node.Value = value
    camera.PixelFormat.Value = "Mono8"
    camera.Width.Value = s.width_px
    camera.Height.Value = s.height_px
    camera.ExposureAuto.TrySetValue("Off")
    camera.GainAuto.TrySetValue("Off")
    camera.ExposureTime.Value = s.exposure_us
    camera.Gain.Value = s.gain_db
    camera.TriggerSelector.Value = "FrameStart"
    camera.TriggerMode.Value = "On"
    camera.TriggerSource.Value = SOURCES[s.trigger]
    camera.MaxNumBuffer.Value = 5


def _flush(camera: pylon.InstantCamera) -> None:
    """A frame that comes late must not be taken for the next part's."""
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

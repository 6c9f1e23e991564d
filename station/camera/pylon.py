"""Basler cameras, real or emulated; the only file that imports pypylon."""

import time
from datetime import UTC, datetime

import numpy as np
from pypylon import genicam, pylon

from station.camera.features import NEEDED, Value, differs, expected
from station.camera.frame_order import FrameOrder, Latch, is_before, is_impossible
from station.domain import Frame, Origin
from station.errors import CameraLost, FrameDamaged, FrameTimeout, FrameUnrequested
from station.settings.camera import PylonSettings

CLOCKS = (
    ("TimestampLatch", "TimestampLatchValue", None),
    ("GevTimestampControlLatch", "GevTimestampValue", "GevTimestampTickFrequency"),
)
"""Nodes that latch the camera's clock, hold its value, and its rate in Hz (None: one tick per ns)."""
LATCH_S = 0.005
"""Time within which a reading of the camera's clock is good enough."""
LATCH_TRIALS = 3


class PylonCamera:
    """A Basler camera, found by device class and serial: a wider search would query all interfaces."""

    def __init__(self, settings: PylonSettings) -> None:
        self._settings = settings
        self._camera: pylon.InstantCamera | None = None
        self._order = FrameOrder()
        self._features = ""
        """All features of the open camera, as text."""

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
            self._features = _configure(camera, settings)
            self._order = FrameOrder()
            camera.StartGrabbing(pylon.GrabStrategy_OneByOne)
            clock = latched(camera)
        except (genicam.GenericException, CameraLost) as error:
            if camera is not None:
                _release(camera)
            name = f"camera {settings.serial} ({settings.device_class})"
            if isinstance(error, CameraLost):
                raise CameraLost(
                    f"{name}: {error}; set it with the maker's tool, or use another camera"
                ) from None
            raise CameraLost(f"{name}: {_first_line(error)}; check power, cable and camera.serial") from None
        self._camera = camera
        if clock is None and settings.trigger != "software" and settings.origin is Origin.CAMERA:
            self.close()
            raise CameraLost(
                f"camera {settings.serial}: its clock cannot be read, so that a frame of an earlier edge "
                'would not be noticed; set camera.trigger = "software"'
            )

    def grab(self, trigger_s: float) -> Frame:
        """Return one frame, by software trigger or the next hardware edge, exposed after `trigger_s`.

        `trigger_s`: monotonic time. Frames of earlier exposures are dropped and counted: the camera's own
        clock tells, or, if it has none, the camera is started again first.
        Raises CameraLost, FrameTimeout, FrameDamaged, FrameUnrequested.
        """
        camera, settings = self._camera, self._settings
        if camera is None:
            raise CameraLost(f"camera {settings.serial} is not open")
        try:
            before, clock = self._order.unrequested, latched(camera)
            if clock is None:
                self._drop_waiting(camera)
            if settings.trigger == "software":
                if not camera.WaitForFrameTriggerReady(settings.timeout_ms, pylon.TimeoutHandling_Return):
                    raise FrameTimeout(
                        f"camera {settings.serial}: not ready for a trigger within {settings.timeout_ms} ms"
                    )
                camera.ExecuteSoftwareTrigger()
            until_s = time.monotonic() + settings.timeout_ms / 1000
            while True:
                left_ms = max(0, round((until_s - time.monotonic()) * 1000))
                with camera.RetrieveResult(left_ms, pylon.TimeoutHandling_Return) as result:
                    taken = result.IsValid() and result.GrabSucceeded()
                    if clock is not None and taken and is_before(stamp(result), clock, trigger_s):
                        self._order.drop(result.BlockID)
                        continue
                    return self._frame(camera, result, clock, self._order.unrequested - before)
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

    def _drop_waiting(self, camera: pylon.InstantCamera) -> None:
        """Drop all frames of earlier exposures, without a clock that tells which they are."""
        while camera.GetGrabResultWaitObject().Wait(0):
            with camera.RetrieveResult(0, pylon.TimeoutHandling_Return) as result:
                if result.IsValid():
                    self._order.drop(result.BlockID)
        if self._settings.trigger != "software":  # a frame may still be on its way
            self._restart(camera)

    def _restart(self, camera: pylon.InstantCamera) -> None:
        """Discard what comes late, so that it is not taken for the frame of the next part."""
        camera.StopGrabbing()
        self._order.restart()
        camera.StartGrabbing(pylon.GrabStrategy_OneByOne)

    def _frame(
        self, camera: pylon.InstantCamera, result: pylon.GrabResult, clock: Latch | None, unrequested: int
    ) -> Frame:
        settings = self._settings
        name = f"camera {settings.serial}"
        if not result.IsValid():
            if not camera.IsGrabbing() or camera.IsCameraDeviceRemoved():
                self.close()
                raise CameraLost(f"{name}: stopped grabbing")
            self._restart(camera)
            if unrequested:
                raise FrameUnrequested(
                    f"{name}: no frame was exposed after the trigger, {unrequested} before it; "
                    "the edge must come after BUSY"
                )
            raise FrameTimeout(f"{name}: no frame within {settings.timeout_ms} ms")
        if not result.GrabSucceeded():
            self._order.skip()
            raise FrameDamaged(
                f"{name}: frame incomplete ({result.GetErrorDescription() or 'no description'})"
            )
        if lost := self._order.lost(result.BlockID):
            raise FrameUnrequested(f"{name}: {lost}")
        if clock is not None and is_impossible(stamp(result), clock, time.monotonic()):
            raise FrameUnrequested(f"{name}: the frame's time stamp lies in the future; its clock was set")
        if (result.Width, result.Height) != (settings.width_px, settings.height_px):
            wanted = f"{settings.width_px} x {settings.height_px}"
            size = f"{result.Width} x {result.Height} px instead of {wanted} px"
            raise FrameDamaged(f"{name}: frame is {size}", wrong_size=True)
        if result.GetPixelType() != pylon.PixelType_Mono8:
            raise FrameDamaged(f"{name}: frame is not Mono8")
        return Frame(
            np.array(result.Array, np.uint8),
            datetime.now(UTC),
            settings.serial,
            settings.origin,
            unrequested=unrequested,
            features=self._features,
        )


def _configure(camera: pylon.InstantCamera, settings: PylonSettings) -> str:
    """Set all features that matter and return all there are, as text. Raises CameraLost if one cannot be set.

    Emulator and ace 2 use the same names.
    """
    for node, size in ((camera.WidthMax, settings.width_px), (camera.HeightMax, settings.height_px)):
        if genicam.IsWritable(node) and node.Value < size:
            node.Value = size
    nodes = camera.GetNodeMap()
    for selector in camera.TriggerSelector.GetSettableValues():
        camera.TriggerSelector.Value = selector
        camera.TriggerMode.TrySetValue("Off")
    values = expected(settings)
    for name, value in values.items():
        _set(nodes.GetNode(name), name, value)
    for name, value in values.items():  # one may have changed another
        node = nodes.GetNode(name)
        if node is not None and genicam.IsReadable(node) and differs(node.Value, value):
            raise CameraLost(f"{name} is {node.Value}, not {value}, after all features were set")
    camera.MaxNumBuffer.Value = 5
    return str(pylon.FeaturePersistence.SaveToString(nodes))


def _set(node: genicam.IValue | None, name: str, value: Value) -> None:
    """Give a feature its value. Raises CameraLost if it is needed and absent, or has another value."""
    if node is None or not (genicam.IsReadable(node) or genicam.IsWritable(node)):
        if name in NEEDED:
            raise CameraLost(f"it has no feature {name}")
        return
    if genicam.IsReadable(node) and not differs(node.Value, value):
        return
    if not genicam.IsWritable(node):
        raise CameraLost(f"{name} is {node.Value}, must be {value}, and cannot be changed")
    node.Value = value
    if genicam.IsReadable(node) and differs(node.Value, value):
        raise CameraLost(f"{name} is {node.Value} although {value} was set")


def latched(camera: pylon.InstantCamera) -> Latch | None:
    """Return a reading of the camera's clock against the host's; None if the camera has no such clock."""
    nodes = camera.GetNodeMap()
    for latch_name, value_name, rate_name in CLOCKS:
        latch, value = nodes.GetNode(latch_name), nodes.GetNode(value_name)
        if latch is None or value is None or not genicam.IsWritable(latch):
            continue
        ticks_per_s = 1e9 if rate_name is None else float(nodes.GetNode(rate_name).Value)
        for _ in range(LATCH_TRIALS):
            before_s = time.monotonic()
            latch.Execute()
            after_s = time.monotonic()
            reading = Latch(ticks=value.Value, before_s=before_s, after_s=after_s, ticks_per_s=ticks_per_s)
            if after_s - before_s <= LATCH_S:
                break
        return reading
    return None


def stamp(result: pylon.GrabResult) -> int:
    """Return the time of the exposure by the camera's clock."""
    return int(result.TimeStamp)


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

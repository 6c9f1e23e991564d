"""Errors of the station; each message is one line: what happened, where, and what to do.

WeldgateError
├── SettingsError      a settings file is missing or wrong
├── ModelError         a model file is missing, damaged or not one of weldgate's
├── ImageError         an image cannot be read or has the wrong form
├── CameraError
│   ├── CameraLost     the camera is absent or stopped answering
│   ├── FrameTimeout   no frame came in time
│   ├── FrameDamaged   a frame came incomplete or in the wrong size
│   └── FrameUnrequested  a frame is not proven to be that of the trigger
├── LocateError        no weld ring, or not completely in view
├── RecordError        a record cannot be written or read
├── LoginError         the login does not allow the action
└── LineError          the PLC connection cannot be made
"""


class WeldgateError(Exception):
    """An error that a user or operator can act upon; the message is one line."""


class SettingsError(WeldgateError):
    """A settings file is missing or wrong."""


class ModelError(WeldgateError):
    """A model file is missing, damaged, or not one of weldgate's."""


class ImageError(WeldgateError):
    """An image cannot be read or has the wrong form."""


class CameraError(WeldgateError):
    """The camera did not give a usable frame."""


class CameraLost(CameraError):
    """The camera is absent or stopped answering; open it again."""


class FrameTimeout(CameraError):
    """No frame came in time, although the camera is connected."""


class FrameDamaged(CameraError):
    """A frame came incomplete or in the wrong size; it must not be judged."""

    def __init__(self, message: str, wrong_size: bool = False) -> None:
        """`wrong_size`: the frame has another size than set."""
        super().__init__(message)
        self.wrong_size = wrong_size


class FrameUnrequested(CameraError):
    """A frame was exposed before the trigger, repeats another or is out of order: perhaps of another part."""


class LocateError(WeldgateError):
    """No weld ring was found, or it is not completely in view."""

    def __init__(self, message: str, out_of_view: bool = False) -> None:
        """`out_of_view`: a ring was found, but not completely in view."""
        super().__init__(message)
        self.out_of_view = out_of_view


class RecordError(WeldgateError):
    """A record cannot be written or read."""


class LoginError(WeldgateError):
    """The login does not allow the action, or failed."""

    def __init__(self, message: str, locked_s: float = 0.0) -> None:
        """`locked_s`: seconds until another PIN may be tried."""
        super().__init__(message)
        self.locked_s = locked_s


class LineError(WeldgateError):
    """The PLC connection cannot be made."""

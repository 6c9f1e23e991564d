"""Values that the features of a GenICam camera must have, so that none stays as somebody left it."""

from station.settings.camera import PylonSettings

Value = str | bool | int | float

PLAIN: dict[str, Value] = {
    "SequencerMode": "Off",
    "AcquisitionMode": "Continuous",
    "AcquisitionFrameRateEnable": False,
    "ImageCompressionMode": "Off",
    "ChunkModeActive": False,
    "TestPattern": "Off",
    "BinningHorizontal": 1,
    "BinningVertical": 1,
    "DecimationHorizontal": 1,
    "DecimationVertical": 1,
    "ScalingHorizontal": 1.0,
    "BslScalingFactor": 1.0,
    "ReverseX": False,
    "ReverseY": False,
    "PixelFormat": "Mono8",
    "BlackLevel": 0.0,
    "GammaEnable": False,
    "Gamma": 1.0,
    "DigitalShift": 0,
    "LUTEnable": False,
    "BslBrightness": 0.0,
    "BslContrast": 0.0,
    "BslContrastMode": "Linear",
    "BslNoiseReduction": 0.0,
    "BslSharpnessEnhancement": 0.0,
    "ExposureAuto": "Off",
    "ExposureMode": "Timed",
    "BslExposureTimeMode": "Standard",
    "GainAuto": "Off",
}
"""Value of each feature with which the networks see grey levels and geometry as the sensor gives them.

A camera that lacks a feature has no wrong value of it.
"""
SOURCES = {"software": "Software", "line1": "Line1"}
"""GenICam name of each trigger source."""
NEEDED = ("PixelFormat", "Width", "Height", "ExposureTime", "Gain", "TriggerMode", "TriggerSource")
"""Features that every camera must have."""
TOLERANCE = 1e-3
"""Difference, relative above 1, at which two numbers count as equal: cameras round to their steps."""


def expected(settings: PylonSettings) -> dict[str, Value]:
    """Return the value of each feature, in the order in which they must be set."""
    return {
        **PLAIN,
        **({} if settings.is_emulated else {"TestImageSelector": "Off"}),  # its images come from there
        "OffsetX": 0,
        "OffsetY": 0,
        "Width": settings.width_px,
        "Height": settings.height_px,
        "ExposureTime": settings.exposure_us,
        "Gain": settings.gain_db,
        "TriggerSelector": "FrameStart",
        "TriggerMode": "On",
        "TriggerSource": SOURCES[settings.trigger],
        "TriggerActivation": "RisingEdge",
        "TriggerDelay": 0.0,
    }


def differs(found: Value, value: Value) -> bool:
    """Return whether a feature has another value than it must have."""
    if isinstance(value, str) or isinstance(found, str):
        return found != value
    return abs(found - value) > TOLERANCE * max(abs(value), 1.0)

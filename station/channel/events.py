"""What the engine tells: frozen messages, defined once."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import ConfigDict

from station.classify.drift import Drift
from station.domain import Origin, Ring
from station.plc.map.registers import VerdictCode
from station.plc.port import LineState
from station.records import Record

STATUS_LOST_S = 2.0
"""A status older than this says nothing: they come several times a second."""
SETTING_UP = -1
"""Number of a picture that is not judged; a part whose record could not be written has 0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StatusEvent:
    """How the station stands; several a second."""

    at_s: float
    """Monotonic time at which it was sent: one clock for all processes of the machine."""
    started_s: float
    """Monotonic time of the engine's start."""
    reloaded_s: float
    """Epoch seconds: `asked_s` of the last request to read the settings again that was dealt with, or 0."""
    camera_there: bool
    camera_message: str
    """Why the camera is not there, or empty."""
    origin: Origin
    line: LineState
    """What the PLC reads, decoded."""
    command_words: tuple[int, ...]
    status_words: tuple[int, ...]
    """Raw words of both windows, for the table of registers on the page Line alone."""
    alarms: tuple[int, ...] = ()
    """Codes of what lasts now."""
    recipe: int = 1
    config_crc: int = 0
    service: str = ""
    """Who works on the station, or empty."""
    type: Literal["status"] = "status"


@dataclass(frozen=True, slots=True, kw_only=True)
class PartEvent:
    """One part judged, recorded and published."""

    at_s: float
    """Monotonic time at which it was sent."""
    record: Record
    novel: bool
    """The picture is unlike all training images: its verdict deserves less trust, and the line a look."""
    drift: Drift | None
    """How far the last parts look from the line's reference; None: not watched, or no part was judged yet."""
    told: VerdictCode
    """What the PLC reads: ERROR also if the result came too late, TEST for a master or while the station may not be trusted, NONE for a
    test picture."""
    record_ms: float
    publish_ms: float
    type: Literal["part"] = "part"


@dataclass(frozen=True, slots=True)
class Preview:
    """Picture for the window: may be dropped."""

    inspection_id: int
    """`SETTING_UP` for a setting-up picture."""
    scale: float
    """Preview pixels per frame pixel."""
    origin_px: tuple[int, int]
    """Frame pixel (x, y) of the preview's corner."""
    frame_jpeg: bytes
    strip_jpeg: bytes
    """Empty if no ring was found."""
    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(ser_json_bytes="base64", val_json_bytes="base64")


@dataclass(frozen=True, slots=True, kw_only=True)
class LookEvent:
    """One setting-up picture in numbers; not judged, not recorded."""

    exposure_us: float | None
    gain_db: float | None
    mean_dn: float
    """Of the whole frame, or of the strip if a ring was found."""
    saturated_share: float
    sharpness: float
    histogram: tuple[int, ...]
    """Pixels in 64 classes of grey level, of the same place."""
    ring: Ring | None
    problem: str = ""
    """Why there is no picture or no ring."""
    type: Literal["look"] = "look"


Event = StatusEvent | PartEvent | LookEvent

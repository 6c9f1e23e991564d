"""Events of the engine for the window: frozen messages, defined once."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import ConfigDict

from station.classify.drift import Drift
from station.domain import Origin, Ring
from station.plc.map.registers import VerdictCode
from station.plc.port import LineState
from station.records import Record

STATUS_LOST_S = 2.0
"""Age from which a status is out of date; a new one comes several times per second."""
SETUP_IMAGE = -1
"""Inspection id of a setup image; a part whose record could not be written has 0."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StatusEvent:
    """State of the station, sent several times per second."""

    at_s: float
    """Monotonic time of sending; all processes of the machine share this clock."""
    started_s: float
    """Monotonic time of the engine's start."""
    camera_there: bool
    camera_message: str
    """Reason why the camera is not connected, or empty."""
    origin: Origin
    line: LineState
    """State of the line, decoded from both windows."""
    command_words: tuple[int, ...]
    """Raw words of the command window, for the register table of the page Line only."""
    status_words: tuple[int, ...]
    """Raw words of the status window, for the register table of the page Line only."""
    alarms: tuple[int, ...] = ()
    """Codes of the active alarms, the most severe first."""
    recipe: int = 1
    config_crc: int = 0
    service: str = ""
    """User in service mode, or empty."""
    type: Literal["status"] = "status"


@dataclass(frozen=True, slots=True, kw_only=True)
class PartEvent:
    """A part that was judged, recorded and published."""

    at_s: float
    """Monotonic time of sending."""
    record: Record
    novel: bool
    """True if the image is unlike all training images; its verdict is less reliable."""
    drift: Drift | None
    """Drift of the last parts from the line's reference; None: not monitored, or no part was judged yet."""
    reported: VerdictCode
    """Verdict that the PLC reads.

    ERROR also if the result came too late, TEST for a master or while the station is not trusted, NONE for a
    test image.
    """
    record_ms: float
    """Time that writing the record took."""
    publish_ms: float
    """Time that publishing the result took."""
    type: Literal["part"] = "part"


@dataclass(frozen=True, slots=True, kw_only=True)
class Preview:
    """Small images of an inspection for the window; may be dropped."""

    inspection_id: int
    """Number of the inspection, or `SETUP_IMAGE`."""
    scale: float
    """Size of the preview: preview pixels per frame pixel."""
    origin_px: tuple[int, int]
    """Upper left corner of the preview in frame pixels (x, y)."""
    frame_jpeg: bytes
    strip_jpeg: bytes
    """The strip; empty if no ring was found."""
    um_per_px: float
    """Scale of the frame."""
    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(ser_json_bytes="base64", val_json_bytes="base64")


@dataclass(frozen=True, slots=True, kw_only=True)
class SetupImageEvent:
    """Measured quality of a setup image, which is neither judged nor recorded."""

    exposure_us: float | None
    gain_db: float | None
    mean_dn: float
    """Mean brightness of the strip, or of the whole frame if no ring was found; the other values likewise."""
    saturated_share: float
    sharpness: float
    histogram: tuple[int, ...]
    """Numbers of pixels in 64 equal bins of the grey level."""
    ring: Ring | None
    problem: str = ""
    """Reason why there is no image or no ring, or empty."""
    type: Literal["look"] = "look"


Event = StatusEvent | PartEvent | SetupImageEvent
"""An event of the engine."""

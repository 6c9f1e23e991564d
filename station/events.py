"""What the engine tells: frozen messages, defined once."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import ConfigDict

from station.classify.drift import Drift
from station.domain import Origin
from station.plc.registers import Offline
from station.records import Record


@dataclass(frozen=True, slots=True)
class Counts:
    """Parts since the engine started."""

    ok: int = 0
    nok: int = 0
    error: int = 0

    @property
    def total(self) -> int:
        """All parts, judged or not."""
        return self.ok + self.nok + self.error


@dataclass(frozen=True, slots=True)
class StatusEvent:
    """How the station stands; several a second."""

    camera_there: bool
    camera_message: str
    """Why the camera is not there, or empty."""
    online: bool
    ready: bool
    offline: Offline
    origin: Origin
    counts: Counts
    type: Literal["status"] = "status"


@dataclass(frozen=True, slots=True)
class PartEvent:
    """One part judged, recorded and published."""

    record: Record
    seg_nok: tuple[bool, ...]
    novel: bool
    """The picture is unlike all training images: its verdict deserves less trust, and the line a look."""
    drift: Drift | None
    """How far the last parts look from the line's reference; None: not watched, or no part was judged yet."""
    shown_to_plc: bool
    """False: the result came too late or was refused; the PLC saw ERROR or nothing."""
    record_ms: float
    publish_ms: float
    type: Literal["part"] = "part"


@dataclass(frozen=True, slots=True)
class Preview:
    """Picture for the window: may be dropped."""

    inspection_id: int
    scale: float
    """Preview pixels per frame pixel."""
    origin_px: tuple[int, int]
    """Frame pixel (x, y) of the preview's corner."""
    frame_jpeg: bytes
    strip_jpeg: bytes
    """Empty if no ring was found."""
    __pydantic_config__: ClassVar[ConfigDict] = ConfigDict(ser_json_bytes="base64", val_json_bytes="base64")


Event = StatusEvent | PartEvent

"""What the engine tells: frozen messages, defined once."""

from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import ConfigDict

from station.classify.drift import Drift
from station.domain import Origin, Ring
from station.plc.registers import STATUS_START, Offline, Status, word
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
    origin: Origin
    counts: Counts
    command_words: tuple[int, ...]
    status_words: tuple[int, ...]
    """Both windows of the register map, as the PLC has them."""
    alarms: tuple[int, ...] = ()
    """Codes of what lasts now."""
    recipe: int = 1
    config_crc: int = 0
    service: str = ""
    """Who works on the station, or empty."""
    type: Literal["status"] = "status"

    @property
    def status(self) -> Status:
        """Bits that the PLC reads."""
        return Status(word(STATUS_START, self.status_words, "STATUS"))

    @property
    def offline(self) -> Offline:
        """Why READY is 0."""
        return Offline(word(STATUS_START, self.status_words, "OFFLINE_REASON"))


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


@dataclass(frozen=True, slots=True)
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

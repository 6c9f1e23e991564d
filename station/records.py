"""Records: one inspection on disk, in format version 4; `station.record_versions` reads versions 1 to 3.

A record has two files: `YYYY-MM-DD/NNNNNNNN.png`, the frame as grabbed, lossless, and `NNNNNNNN.json`,
everything that led to its verdict. The index is `index.sqlite` next to the day folders. Any image viewer and
any SQLite tool can read them.
"""

import json
from dataclasses import dataclass, field
from datetime import datetime
from math import isfinite

from pydantic import TypeAdapter

from station.classify.thresholds import Thresholds
from station.domain import NETWORK_UM_PER_PX, Inspection, Origin, Purpose, Verdict
from station.record_versions import FORMAT, OLD, upgraded


@dataclass(frozen=True, slots=True, kw_only=True)
class Provenance:
    """What judged a part: software, networks and limits."""

    software: str
    model_version: str
    model_hash: str
    ring_model_hash: str
    seen_model_hash: str = field(default="", kw_only=True)
    """SHA-256 of the network that says what is hidden; empty in records before format 4."""
    config_crc: int
    thresholds: Thresholds
    """Thresholds and minimum lengths of the decision."""
    recipe: int = 1
    limits_hash: str = ""
    """SHA-256 of the settings of weld and quality gate, on which a verdict depends too."""
    um_per_px: float = NETWORK_UM_PER_PX
    """Scale of the frame, at which its strip was cut. Older records lack it: their strips have rows of one
    frame pixel, whatever the scale was."""

    def __post_init__(self) -> None:
        if not self.um_per_px > 0:
            raise ValueError(f"a scale of {self.um_per_px} µm/px is not above 0")

    @property
    def limits(self) -> str:
        """Thresholds and minimum lengths as text."""
        kinds = self.thresholds.kinds
        words = [f"{limit.kind.reason} {limit.threshold:g}" for limit in kinds]
        words += [f"segment {number}: {limit:g}" for number, limit in self.thresholds.segments]
        words += [
            f"{limit.kind.reason} below {limit.min_mm:g} mm tolerated" for limit in kinds if limit.min_mm > 0
        ]
        return ", ".join(words)


@dataclass(frozen=True, slots=True)
class Part:
    """Identity of a part as given by the PLC, and the origin of its frame."""

    serial: str
    trigger_id: int
    origin: Origin
    purpose: Purpose = Purpose.PART


@dataclass(frozen=True, slots=True, kw_only=True)
class Record:
    """One inspected part as stored on disk."""

    inspection_id: int
    serial: str
    trigger_id: int
    grabbed_at: datetime
    source: str
    origin: Origin
    frame_file: str | None
    """Path of the frame relative to the archive folder; None if there was no frame or it was not stored."""
    frame_sha256: str | None
    inspection: Inspection
    provenance: Provenance
    purpose: Purpose = Purpose.PART
    camera_sha256: str | None = None
    """SHA-256 of the camera's features, which are in `cameras/` under this name; None for recorded images."""
    chain_before: str = ""
    """Hash of the chain of all records before this one."""
    format: int = FORMAT

    @property
    def verdict(self) -> Verdict:
        """Verdict of the inspection; never changed afterwards."""
        return self.inspection.verdict


def _refuse(name: str) -> float:
    raise ValueError(f"{name} is not a number")


def _finite(text: str) -> float:
    value = float(text)
    return value if isfinite(value) else _refuse(text)


_ADAPTER = TypeAdapter(Record)


def to_json(record: Record) -> bytes:
    """Return the record's JSON text."""
    return _ADAPTER.dump_json(record, indent=1)


def from_json(text: bytes) -> Record:
    """Return the record in this JSON text of any version. Raises ValueError, also for NaN and infinity."""
    try:
        raw = json.loads(text, parse_constant=_refuse, parse_float=_finite)
        if raw.get("format", 1) in OLD:
            text = json.dumps(upgraded(raw)).encode()
    except (KeyError, TypeError, AttributeError, IndexError, RecursionError) as error:
        raise ValueError(f"not a record ({type(error).__name__})") from None
    return _ADAPTER.validate_json(text, strict=True)

"""One inspection on disk. Version 2; version 1 lacks look, purpose, recipe and chain, and is read.

A record is `YYYY-MM-DD/NNNNNNNN.png`, the frame as grabbed, lossless, and `NNNNNNNN.json`, all that led to its verdict;
the index is `index.sqlite` beside the day folders. Readable with any image viewer and any SQLite tool.
"""

from dataclasses import dataclass
from datetime import datetime

from pydantic import TypeAdapter

from station.classify.thresholds import Thresholds
from station.domain import Inspection, Origin, Purpose, Verdict

FORMAT = 2


@dataclass(frozen=True, slots=True)
class Provenance:
    """Which software judged, by which model and limits."""

    software: str
    model_version: str
    model_hash: str
    ring_model_hash: str
    config_crc: int
    hole_threshold: float
    missing_threshold: float
    recipe: int = 1
    limits_hash: str = ""
    """SHA-256 of the settings of weld and quality gate: what else a verdict depends on."""
    segment_thresholds: tuple[tuple[int, float], ...] = ()
    """Of segments with a limit of their own."""
    hole_min_mm: float = 0.0
    missing_min_mm: float = 0.0

    @property
    def limits(self) -> str:
        """The same in words."""
        words = [f"hole {self.hole_threshold:g}", f"missing weld {self.missing_threshold:g}"]
        words += [f"segment {number}: {limit:g}" for number, limit in self.segment_thresholds]
        words += [f"holes below {self.hole_min_mm:g} mm tolerated"] * (self.hole_min_mm > 0)
        words += [f"missing weld below {self.missing_min_mm:g} mm tolerated"] * (self.missing_min_mm > 0)
        return ", ".join(words)

    @property
    def thresholds(self) -> Thresholds:
        """All limits of the decision."""
        segments, hole_mm, missing_mm = self.segment_thresholds, self.hole_min_mm, self.missing_min_mm
        return Thresholds(self.hole_threshold, self.missing_threshold, segments, hole_mm, missing_mm)


@dataclass(frozen=True, slots=True)
class Part:
    """Which part, as the PLC named it, and where its picture comes from."""

    serial: str
    trigger_id: int
    origin: Origin
    purpose: Purpose = Purpose.PART


@dataclass(frozen=True, slots=True)
class Record:
    """One judged part as kept on disk."""

    inspection_id: int
    serial: str
    trigger_id: int
    grabbed_at: datetime
    source: str
    origin: Origin
    frame_file: str | None
    """Relative to the archive folder; None if no frame came."""
    frame_sha256: str | None
    inspection: Inspection
    provenance: Provenance
    purpose: Purpose = Purpose.PART
    chain_before: str = ""
    """Hash over all records before this one."""
    format: int = FORMAT

    @property
    def verdict(self) -> Verdict:
        """Verdict as decided; never changed afterwards."""
        return self.inspection.verdict


_ADAPTER = TypeAdapter(Record)


def to_json(record: Record) -> bytes:
    """The record's JSON text."""
    return _ADAPTER.dump_json(record, indent=1)


def from_json(text: bytes) -> Record:
    """A record from its JSON text. Raises pydantic.ValidationError."""
    return _ADAPTER.validate_json(text)

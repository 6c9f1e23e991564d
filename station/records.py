"""One inspection on disk. Version 3; versions 1 and 2 are read (`station.record_versions`).

A record is `YYYY-MM-DD/NNNNNNNN.png`, the frame as grabbed, lossless, and `NNNNNNNN.json`, all that led to its verdict;
the index is `index.sqlite` beside the day folders. Readable with any image viewer and any SQLite tool.
"""

import json
from dataclasses import dataclass
from datetime import datetime

from pydantic import TypeAdapter, ValidationError

from station.classify.thresholds import Thresholds
from station.domain import Inspection, Origin, Purpose, Verdict
from station.record_versions import FORMAT, OLD, upgraded


@dataclass(frozen=True, slots=True)
class Provenance:
    """Which software judged, by which model and limits."""

    software: str
    model_version: str
    model_hash: str
    ring_model_hash: str
    config_crc: int
    thresholds: Thresholds
    """All limits of the decision."""
    recipe: int = 1
    limits_hash: str = ""
    """SHA-256 of the settings of weld and quality gate: what else a verdict depends on."""

    @property
    def limits(self) -> str:
        """The thresholds and minimum lengths in words."""
        kinds = self.thresholds.kinds
        words = [f"{limit.kind.reason} {limit.threshold:g}" for limit in kinds]
        words += [f"segment {number}: {limit:g}" for number, limit in self.thresholds.segments]
        words += [
            f"{limit.kind.reason} below {limit.min_mm:g} mm tolerated" for limit in kinds if limit.min_mm > 0
        ]
        return ", ".join(words)


@dataclass(frozen=True, slots=True)
class Part:
    """Which part, as the PLC named it, and where its picture comes from."""

    serial: str
    trigger_id: int
    origin: Origin
    purpose: Purpose = Purpose.PART


@dataclass(frozen=True, slots=True, kw_only=True)
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
    """Return the record's JSON text."""
    return _ADAPTER.dump_json(record, indent=1)


def from_json(text: bytes) -> Record:
    """Return a record from its JSON text, also of an older version. Raises pydantic.ValidationError."""
    try:
        return _ADAPTER.validate_json(text)
    except ValidationError as error:
        try:
            raw = json.loads(text)
            if raw.get("format", 1) not in OLD:
                raise error
            return _ADAPTER.validate_json(json.dumps(upgraded(raw)))
        except (ValueError, KeyError, TypeError, AttributeError):
            raise error from None

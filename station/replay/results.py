"""Writes the results of a replay: JSON with all values, CSV with one row per image.

Only `as_entry` and `from_entry` know the JSON form.
"""

import csv
import io
import json
from collections.abc import Iterable
from pathlib import Path
from typing import NotRequired, TypedDict

from station.defects import Reason
from station.domain import SEGMENTS, Finding, SegmentQuality, Unseen, Verdict
from station.files.durable import write_whole
from station.replay.replayed import Circle, Replayed


class FindingEntry(TypedDict):
    """JSON form of a finding."""

    kind: str
    start_deg: float
    end_deg: float
    length_mm: float
    score: float
    width_mm: float | None
    area_mm2: float | None


class SegmentQualityEntry(TypedDict):
    """JSON form of the image quality of a segment."""

    mean_dn: float
    dark_fraction: float
    saturated_fraction: float
    contrast: float
    sharpness: float
    fine_structure: float
    weld: float
    visible: float | None


class Entry(TypedDict):
    """JSON form of the result for one image: pixels of the input image, angle 0 at +x, clockwise as seen.

    `segments` has None for a segment that was not seen and is not rejected. `unseen` has the cause for each
    segment that was not seen; it is None, like `segment_quality`, if no segment was looked at.
    An image that could not be inspected has only the keys `verdict`, `reason`, `segments` and `findings`.
    """

    center: NotRequired[list[float] | None]
    radius: NotRequired[float | None]
    verdict: str
    reason: str | None
    detail: NotRequired[str | None]
    segments: list[float | None]
    unseen: NotRequired[list[str | None] | None]
    segment_quality: NotRequired[list[SegmentQualityEntry] | None]
    unwrap_start_deg: NotRequired[float]
    direction: NotRequired[str]
    findings: list[FindingEntry]
    novelty: NotRequired[float | None]
    inspection_ms: NotRequired[float]


def as_entry(replayed: Replayed) -> Entry:
    """Return the JSON form of a result, without name and warnings."""
    if replayed.inspection_ms is None:
        return {
            "verdict": str(replayed.verdict),
            "reason": replayed.reason,
            "segments": [None] * SEGMENTS,
            "findings": [],
        }
    circle = replayed.circle
    return {
        "center": None if circle is None else [circle.center_x_px, circle.center_y_px],
        "radius": None if circle is None else circle.radius_px,
        "verdict": str(replayed.verdict),
        "reason": replayed.reason,
        "detail": replayed.detail,
        "segments": list(replayed.scores) or [None] * SEGMENTS,
        "unseen": [None if cause is None else str(cause) for cause in replayed.unseen] or None,
        "segment_quality": [_quality_entry(quality) for quality in replayed.segment_quality] or None,
        "unwrap_start_deg": 0.0,
        "direction": "cw",
        "findings": [_finding_entry(finding) for finding in replayed.findings],
        "novelty": replayed.novelty,
        "inspection_ms": replayed.inspection_ms,
    }


def from_entry(name: str, entry: Entry, warnings: Iterable[str] = ()) -> Replayed:
    """Return the result with this JSON form.

    Raises ValueError, KeyError, TypeError, AttributeError or IndexError if `entry` does not have this form.
    """
    center, radius = entry.get("center"), entry.get("radius")
    return Replayed(
        name=name,
        verdict=Verdict(entry["verdict"]),
        reason=entry["reason"],
        circle=None if center is None or radius is None else Circle(center[0], center[1], radius),
        scores=() if set(entry["segments"]) == {None} else tuple(entry["segments"]),
        findings=tuple(_finding(finding) for finding in entry["findings"]),
        novelty=entry.get("novelty"),
        detail=entry.get("detail"),
        unseen=tuple(None if cause is None else Unseen(cause) for cause in entry.get("unseen") or ()),
        segment_quality=tuple(SegmentQuality(**quality) for quality in entry.get("segment_quality") or ()),
        inspection_ms=entry.get("inspection_ms"),
        warnings=tuple(warnings),
    )


def _quality_entry(quality: SegmentQuality) -> SegmentQualityEntry:
    return {
        "mean_dn": quality.mean_dn,
        "dark_fraction": quality.dark_fraction,
        "saturated_fraction": quality.saturated_fraction,
        "contrast": quality.contrast,
        "sharpness": quality.sharpness,
        "fine_structure": quality.fine_structure,
        "weld": quality.weld,
        "visible": quality.visible,
    }


def _finding_entry(finding: Finding) -> FindingEntry:
    return {
        "kind": str(finding.kind),
        "start_deg": finding.start_deg,
        "end_deg": finding.end_deg,
        "length_mm": finding.length_mm,
        "score": finding.score,
        "width_mm": finding.width_mm,
        "area_mm2": finding.area_mm2,
    }


def _finding(entry: FindingEntry) -> Finding:
    return Finding(
        kind=Reason(entry["kind"]),
        start_deg=entry["start_deg"],
        end_deg=entry["end_deg"],
        length_mm=entry["length_mm"],
        score=entry["score"],
        width_mm=entry["width_mm"],
        area_mm2=entry["area_mm2"],
    )


def write_json(path: Path, results: Iterable[Replayed]) -> None:
    """Write all results as a JSON object by name. Raises OSError."""
    _write(path, json.dumps({replayed.name: as_entry(replayed) for replayed in results}, indent=1))


def write_csv(path: Path, results: Iterable[Replayed]) -> None:
    """Write name, verdict, reason, ring, highest score and detail of each image as CSV. Raises OSError."""
    table = io.StringIO(newline="")
    writer = csv.writer(table)
    ring_names = ("center_x_px", "center_y_px", "radius_px")
    writer.writerow(("file", "verdict", "reason", *ring_names, "worst_p_nok", "detail"))
    for replayed in results:
        circle = replayed.circle
        ring = (None,) * 3 if circle is None else (circle.center_x_px, circle.center_y_px, circle.radius_px)
        verdict = str(replayed.verdict)
        writer.writerow((replayed.name, verdict, replayed.reason, *ring, replayed.worst, replayed.detail))
    _write(path, table.getvalue())


def _write(path: Path, text: str) -> None:
    """Write a file atomically; characters of file names that UTF-8 cannot encode are escaped."""
    write_whole(path, text.encode("utf-8", "backslashreplace"))

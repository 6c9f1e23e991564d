"""Converts records of format versions 1 to 3 to the current version.

Version 1 has no appearance, purpose, recipe and chain. In versions 1 and 2 the kinds of defect are field
names instead of data, and the decision on each segment is missing. Up to version 3 nobody looked whether each
segment was seen: all count as seen where they were judged, as the verdict was made on that.
"""

from typing import Any

from pydantic import TypeAdapter

from station.classify.decision import rejected_kinds
from station.classify.thresholds import Thresholds
from station.domain import Finding, SegmentScores

FORMAT = 4
"""Version of the record format that is written."""
OLD = (1, 2, 3)
"""Older versions that can be read."""
KINDS = {"hole": ("hole_threshold", "hole_min_mm"), "missing_weld": ("missing_threshold", "missing_min_mm")}
"""Kinds of defect in the old versions, with the field names of their threshold and minimum length."""

_SCORES = TypeAdapter(tuple[SegmentScores, ...])
_FINDINGS = TypeAdapter(tuple[Finding, ...])
_THRESHOLDS = TypeAdapter(Thresholds)


def upgraded(raw: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON object of a record of version 1, 2 or 3 as an object of the current version.

    Raises KeyError, TypeError or ValueError if `raw` is not a record of an older version.
    """
    as_three = raw if raw.get("format", 1) == 3 else _from_two(raw)
    inspection = as_three["inspection"]
    unseen = [None] * len(inspection["scores"])
    return {**as_three, "inspection": {**inspection, "unseen": unseen}, "format": FORMAT}


def _from_two(raw: dict[str, Any]) -> dict[str, Any]:
    inspection, provenance = dict(raw["inspection"]), dict(raw["provenance"])
    limits = [
        {"kind": kind, "threshold": provenance.pop(threshold), "min_mm": provenance.pop(min_mm, 0.0)}
        for kind, (threshold, min_mm) in KINDS.items()
    ]
    provenance["thresholds"] = {"kinds": limits, "segments": provenance.pop("segment_thresholds", [])}
    inspection["scores"] = [
        {"ok": scores["ok"], "defects": {kind: scores[kind] for kind in KINDS}}
        for scores in inspection["scores"]
    ]
    rejected = rejected_kinds(
        _SCORES.validate_python(inspection["scores"]),
        _FINDINGS.validate_python(inspection["findings"]),
        _THRESHOLDS.validate_python(provenance["thresholds"]),
    )
    return {
        **raw,
        "inspection": {**inspection, "rejected": list(rejected)},
        "provenance": provenance,
    }

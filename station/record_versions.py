"""Converts records of format versions 1 and 2 to the current version.

Version 1 has no appearance, purpose, recipe and chain. In both versions the kinds of defect are field names
instead of data, and the decision on each segment is missing.
"""

from typing import Any

from pydantic import TypeAdapter

from station.classify.decision import rejected_kinds
from station.classify.thresholds import Thresholds
from station.domain import Finding, SegmentScores

FORMAT = 3
"""Version of the record format that is written."""
OLD = (1, 2)
"""Older versions that can be read."""
KINDS = {"hole": ("hole_threshold", "hole_min_mm"), "missing_weld": ("missing_threshold", "missing_min_mm")}
"""Kinds of defect in the old versions, with the field names of their threshold and minimum length."""

_SCORES = TypeAdapter(tuple[SegmentScores, ...])
_FINDINGS = TypeAdapter(tuple[Finding, ...])
_THRESHOLDS = TypeAdapter(Thresholds)


def upgraded(raw: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON object of a record of version 1 or 2 as an object of the current version.

    Raises KeyError, TypeError or ValueError if `raw` is not a record of version 1 or 2.
    """
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
        "format": FORMAT,
    }

"""Older versions of a record, brought to today's form: version 1 lacks look, purpose, recipe and chain; in both versions the kinds of
defect are field names instead of data, and the decision on each segment is not kept."""

from typing import Any

from pydantic import TypeAdapter

from station.classify.decision import rejected_kinds
from station.classify.thresholds import Thresholds
from station.domain import Finding, SegmentScores

FORMAT = 3
OLD = (1, 2)
KINDS = {"hole": ("hole_threshold", "hole_min_mm"), "missing_weld": ("missing_threshold", "missing_min_mm")}
"""The kinds of defect of those versions, with the fields of their limits."""

_SCORES = TypeAdapter(tuple[SegmentScores, ...])
_FINDINGS = TypeAdapter(tuple[Finding, ...])
_THRESHOLDS = TypeAdapter(Thresholds)


def upgraded(raw: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON object of a record of version 1 or 2 as one of today's version.

    Raises KeyError, TypeError or ValueError if it is not such an object.
    """
    inspection, provenance = dict(raw["inspection"]), dict(raw["provenance"])
    limits = [
        {"kind": kind, "threshold": provenance.pop(threshold), "min_mm": provenance.pop(min_mm, 0.0)}
        for kind, (threshold, min_mm) in KINDS.items()
    ]
    provenance["thresholds"] = {"kinds": limits, "segments": provenance.pop("segment_thresholds", [])}
    inspection["scores"] = [
        {"ok": s["ok"], "defects": {kind: s[kind] for kind in KINDS}} for s in inspection["scores"]
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

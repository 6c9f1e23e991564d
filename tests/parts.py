"""What tests are made of: the shipped rendered frames with their labels, and small things made in code."""

import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from station.domain import SEGMENTS, Inspection, Origin, Quality, Reason, Ring, SegmentScores, Timing, Verdict
from station.records import Provenance, Record

FRAMES = Path(__file__).resolve().parent.parent / "deploy" / "frames"


def labels() -> list[dict[str, Any]]:
    """Labels of the shipped frames."""
    return list(json.loads((FRAMES / "labels.json").read_text())["frames"])


def label_with(truth: str) -> dict[str, Any]:
    """A shipped frame of that truth."""
    return next(item for item in labels() if item["truth"] == truth)


def good_scores() -> tuple[SegmentScores, ...]:
    """21 clean segments."""
    return (SegmentScores(0.99, 0.005, 0.005),) * SEGMENTS


def ok_inspection() -> Inspection:
    """A part that was judged OK."""
    return Inspection(
        Verdict.OK,
        None,
        ring=Ring(2100.0, 1080.0, 428.0, 1.0),
        quality=Quality(100.0, 0.0, 0.0, 0.1),
        scores=good_scores(),
        timing=Timing(12.0, 30.0, 3.0, 9.0),
    )


def nok_inspection() -> Inspection:
    """A part with a hole in segment 3."""
    scores = list(good_scores())
    scores[3] = SegmentScores(0.1, 0.9, 0.0)
    return replace(ok_inspection(), verdict=Verdict.NOK, reason=Reason.HOLE, scores=tuple(scores))


def provenance() -> Provenance:
    """Some software and model."""
    return Provenance("0.1.0", "1", "abc", "def", 0x1234, 0.5, 0.5)


def record(inspection: Inspection, number: int = 1, origin: Origin = Origin.SIMULATED) -> Record:
    """A record that was never on disk."""
    return Record(number, f"S{number}", number, datetime.now(UTC), "cam", origin, None, None, inspection, provenance())

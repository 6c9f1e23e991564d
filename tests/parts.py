"""What tests are made of: the shipped rendered frames with their labels, and small things made in code."""

import json
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS, Reason, kind_named
from station.domain import (
    SEGMENTS,
    Inspection,
    Origin,
    Quality,
    Ring,
    SegmentQuality,
    SegmentScores,
    Timing,
    Unseen,
    Verdict,
)
from station.records import Provenance, Record

HOLE, MISSING_WELD = kind_named("hole"), kind_named("missing_weld")
FRAMES = Path(__file__).resolve().parent.parent / "deploy" / "frames"


def labels() -> list[dict[str, Any]]:
    """Labels of the shipped frames."""
    return list(json.loads((FRAMES / "labels.json").read_text())["frames"])


def label_with(truth: str) -> dict[str, Any]:
    """A shipped frame of that truth."""
    return next(item for item in labels() if item["truth"] == truth)


def good_scores() -> tuple[SegmentScores, ...]:
    """21 clean segments."""
    return (scores_of(0.99, 0.005, 0.005),) * SEGMENTS


def scores_of(ok: float, hole: float, missing_weld: float) -> SegmentScores:
    """Scores of one segment; any further kinds of defect have none."""
    return SegmentScores(ok, {**dict.fromkeys(KINDS, 0.0), HOLE: hole, MISSING_WELD: missing_weld})


def thresholds(
    hole: float,
    missing_weld: float,
    segments: tuple[tuple[int, float], ...] = (),
    hole_mm: float = 0.0,
    missing_mm: float = 0.0,
) -> Thresholds:
    """Limits of holes and missing weld."""
    return Thresholds((Limit(HOLE, hole, hole_mm), Limit(MISSING_WELD, missing_weld, missing_mm)), segments)


def segment_quality() -> SegmentQuality:
    """A segment that was well seen."""
    return SegmentQuality(
        mean_dn=100.0,
        dark_fraction=0.0,
        saturated_fraction=0.0,
        contrast=0.3,
        sharpness=0.1,
        fine_structure=1.0,
        weld=1.0,
    )


def unseen_inspection() -> Inspection:
    """A part whose segment 5 was too dark."""
    dark = replace(segment_quality(), mean_dn=3.0, dark_fraction=0.91)
    return replace(
        ok_inspection(),
        verdict=Verdict.ERROR,
        reason=Reason.SEGMENT_NOT_SEEN,
        segment_quality=tuple(dark if i == 4 else segment_quality() for i in range(SEGMENTS)),
        unseen=tuple(Unseen.TOO_DARK if i == 4 else None for i in range(SEGMENTS)),
        detail="segment 5: too dark (mean grey level 3.0, limit 10)",
    )


def ok_inspection() -> Inspection:
    """A part that was judged OK."""
    return Inspection(
        Verdict.OK,
        None,
        ring=Ring(2100.0, 1080.0, 428.0, 1.0),
        quality=Quality(100.0, 0.0, 0.0, 0.1),
        scores=good_scores(),
        rejected=(None,) * SEGMENTS,
        segment_quality=(segment_quality(),) * SEGMENTS,
        unseen=(None,) * SEGMENTS,
        timing=Timing(12.0, 30.0, 3.0, 9.0),
    )


def nok_inspection() -> Inspection:
    """A part with a hole in segment 3."""
    bad = list(good_scores())
    bad[3] = scores_of(0.1, 0.9, 0.0)
    rejected = tuple(Reason.HOLE if i == 3 else None for i in range(SEGMENTS))
    return replace(
        ok_inspection(), verdict=Verdict.NOK, reason=Reason.HOLE, scores=tuple(bad), rejected=rejected
    )


def provenance() -> Provenance:
    """Some software and model."""
    return Provenance(
        software="0.1.0",
        model_version="1",
        model_hash="abc",
        ring_model_hash="def",
        config_crc=0x1234,
        thresholds=thresholds(0.5, 0.5),
    )


def record(inspection: Inspection, number: int = 1, origin: Origin = Origin.SIMULATED) -> Record:
    """A record that was never on disk."""
    return Record(
        inspection_id=number,
        serial=f"S{number}",
        trigger_id=number,
        grabbed_at=datetime.now(UTC),
        source="cam",
        origin=origin,
        frame_file=None,
        frame_sha256=None,
        inspection=inspection,
        provenance=provenance(),
    )

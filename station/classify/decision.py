"""Scores and thresholds to findings and verdict; pure."""

from dataclasses import dataclass
from math import pi

from station.domain import SEGMENT_DEG, SEGMENTS, Finding, Reason, SegmentScores


@dataclass(frozen=True, slots=True)
class Thresholds:
    """A segment is NOK from these probabilities on."""

    hole: float
    missing_weld: float


def segment_kind(scores: SegmentScores, thresholds: Thresholds) -> Reason | None:
    """What is wrong with one segment; the likelier defect if both are, and any segment not likelier OK than not."""
    hole, gone = scores.hole >= thresholds.hole, scores.missing_weld >= thresholds.missing_weld
    if not (hole or gone) and scores.ok > max(scores.hole, scores.missing_weld):
        return None
    return Reason.MISSING_WELD if scores.missing_weld >= scores.hole else Reason.HOLE


def findings(scores: tuple[SegmentScores, ...], thresholds: Thresholds, radius_mm: float) -> tuple[Finding, ...]:
    """Defects, neighbouring segments of one kind merged, also over the seam from segment 20 to segment 0.

    Angles are those of whole segments: a defect is placed to 17 degrees.
    """
    kinds = [segment_kind(s, thresholds) for s in scores]
    if len(kinds) != SEGMENTS:
        raise ValueError(f"{len(kinds)} segments, needed {SEGMENTS}")
    starts = [i for i in range(SEGMENTS) if kinds[i] is not None and kinds[i - 1] != kinds[i]]
    if not starts and kinds[0] is not None:
        starts = [0]
    found = []
    for start in starts:
        kind = kinds[start]
        if kind is None:
            continue
        length = 1
        while length < SEGMENTS and kinds[(start + length) % SEGMENTS] == kind:
            length += 1
        members = [scores[(start + i) % SEGMENTS] for i in range(length)]
        found.append(
            Finding(
                kind=kind,
                start_deg=start * SEGMENT_DEG,
                end_deg=(start + length) * SEGMENT_DEG,
                length_mm=length * SEGMENT_DEG * pi / 180 * radius_mm,
                score=max(s.nok for s in members),
            )
        )
    return tuple(found)

"""Scores, defect maps and thresholds to findings and verdict; pure."""

from collections.abc import Sequence
from math import exp, log, pi

from station.classify.extent import Extent, Map, extents, whole_map
from station.classify.thresholds import Thresholds
from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_COLUMNS, STRIP_ROWS, Finding, Reason, Ring, SegmentScores

KINDS = (Reason.HOLE, Reason.MISSING_WELD)
"""Kinds of defect, in the order of the map's channels."""
JOIN_MM = {Reason.HOLE: 0.0, Reason.MISSING_WELD: 1.0}
"""A missing weld whose joint is hard to see for less than this is one; two holes side by side are two."""
DEG_PER_PX = 360.0 / STRIP_COLUMNS


def segment_kind(scores: SegmentScores, thresholds: Thresholds) -> Reason | None:
    """What is wrong with one segment; the likelier defect if both are, and any segment not likelier OK than not."""
    hole, gone = scores.hole >= thresholds.hole, scores.missing_weld >= thresholds.missing_weld
    if not (hole or gone) and scores.ok > max(scores.hole, scores.missing_weld):
        return None
    return Reason.MISSING_WELD if scores.missing_weld >= scores.hole else Reason.HOLE


def near_threshold(scores: SegmentScores, thresholds: Thresholds) -> bool:
    """Whether a segment is neither clearly OK nor clearly NOK: a second look is worth its time."""
    return any(t / 8 <= p < 1 - (1 - t) / 8 for p, t in ((scores.hole, thresholds.hole), (scores.missing_weld, thresholds.missing_weld)))


def mean_of(views: Sequence[SegmentScores]) -> SegmentScores:
    """Scores of a segment seen more than once: the mean of the logarithms, scaled to add up to 1."""
    logs = [[log(max(p, 1e-9)) for p in (s.ok, s.hole, s.missing_weld)] for s in views]
    ok, hole, gone = (exp(sum(column) / len(views)) for column in zip(*logs, strict=True))
    return SegmentScores(ok / (ok + hole + gone), hole / (ok + hole + gone), gone / (ok + hole + gone))


def findings(scores: Sequence[SegmentScores], maps: Map, thresholds: Thresholds, ring: Ring, um_per_px: float) -> tuple[Finding, ...]:
    """Defects of the whole weld: the map's areas that reach into a refused segment of their kind, over crops and seam.

    `maps` (21, 2, 32, 32) float32. A refused segment whose map shows nothing is a finding of its own, with the segment's angles
    and neither width nor area; such neighbours of one kind are one. So every refused segment is in a finding.
    """
    kinds = [segment_kind(s, thresholds.of(i)) for i, s in enumerate(scores)]
    if len(kinds) != SEGMENTS or maps.shape[0] != SEGMENTS:
        raise ValueError(f"{len(kinds)} segments with {maps.shape[0]} maps, needed {SEGMENTS}")
    found: list[Finding] = []
    unseen: list[Reason | None] = list(kinds)
    for channel, kind in zip(whole_map(maps), KINDS, strict=True):
        if kind not in kinds:
            continue
        for extent in extents(channel, JOIN_MM[kind] * 1000 / um_per_px):
            if any(kinds[s] is kind for s in extent.segments):
                found.append(_measured(kind, extent, scores, ring, um_per_px))
                unseen = [None if s in extent.segments and k is kind else k for s, k in enumerate(unseen)]
    found += _whole_segments(unseen, scores, ring, um_per_px)
    return tuple(sorted(found, key=lambda f: f.start_deg))


def refused_kinds(scores: Sequence[SegmentScores], found: Sequence[Finding], thresholds: Thresholds) -> list[Reason | None]:
    """Kind of each segment that is refused: over its limit, and not for tolerated findings alone. None for the others."""
    kinds = [segment_kind(s, thresholds.of(i)) for i, s in enumerate(scores)]
    return [kind if kind is None or not _tolerated(i, kind, scores[i], found, thresholds) else None for i, kind in enumerate(kinds)]


def _tolerated(index: int, kind: Reason, scores: SegmentScores, found: Sequence[Finding], thresholds: Thresholds) -> bool:
    """Whether all of its kind in a segment and its neighbours was measured and is, taken together, shorter than the least length.

    Never where the other kind is over its limit too: the map was not asked for it.
    """
    limits = thresholds.of(index)
    if scores.hole >= limits.hole and scores.missing_weld >= limits.missing_weld:
        return False
    start, end = index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG
    of_kind = [f for f in found if f.kind is kind]
    near = [f for f in of_kind if _reaches(f, start - SEGMENT_DEG, end + SEGMENT_DEG)]
    if not any(_reaches(f, start, end) for f in of_kind) or any(f.area_mm2 is None for f in near):
        return False
    return sum(max(f.length_mm, f.width_mm or 0.0) for f in near) < thresholds.least_mm(kind)


def _reaches(finding: Finding, start_deg: float, end_deg: float) -> bool:
    return any(finding.start_deg < end_deg + turn and finding.end_deg > start_deg + turn for turn in (-360.0, 0.0, 360.0))


def _measured(kind: Reason, extent: Extent, scores: Sequence[SegmentScores], ring: Ring, um_per_px: float) -> Finding:
    """Length along the weld at the defect's own radius. Width: of a hole from edge to edge, of a bare joint the mean."""
    mm_per_px = um_per_px / 1000
    radius_px = ring.radius_px + STRIP_ROWS / 2 - (extent.top_px + extent.bottom_px) / 2
    columns = extent.end_px - extent.start_px
    stretch = radius_px * 2 * pi / STRIP_COLUMNS
    width_px = extent.bottom_px - extent.top_px if kind is Reason.HOLE else extent.area_px2 / columns
    return Finding(
        kind=kind,
        start_deg=extent.start_px * DEG_PER_PX,
        end_deg=extent.end_px * DEG_PER_PX,
        length_mm=columns * stretch * mm_per_px,
        score=max(scores[s].nok for s in extent.segments),
        width_mm=width_px * mm_per_px,
        area_mm2=extent.area_px2 * stretch * mm_per_px**2,
    )


def _whole_segments(kinds: Sequence[Reason | None], scores: Sequence[SegmentScores], ring: Ring, um_per_px: float) -> list[Finding]:
    starts = [i for i in range(SEGMENTS) if kinds[i] is not None and kinds[i - 1] != kinds[i]]
    if not starts and kinds[0] is not None:
        starts = [0]
    found = []
    for start in starts:
        kind = kinds[start]
        length = 1
        while length < SEGMENTS and kinds[(start + length) % SEGMENTS] == kind:
            length += 1
        if kind is not None:
            arc_mm = length * SEGMENT_DEG * pi / 180 * ring.radius_px * um_per_px / 1000
            score = max(scores[(start + i) % SEGMENTS].nok for i in range(length))
            found.append(Finding(kind, start * SEGMENT_DEG, (start + length) * SEGMENT_DEG, arc_mm, score))
    return found

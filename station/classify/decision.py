"""Scores, defect maps and thresholds to findings and verdict; pure."""

from collections.abc import Sequence
from functools import reduce
from math import exp, log, pi
from operator import add

from station.classify.extent import Extent, Map, extents, whole_map
from station.classify.thresholds import Thresholds
from station.defects import DefectKind, Reason, Width
from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_COLUMNS, STRIP_ROWS, Finding, Ring, SegmentScores

DEG_PER_PX = 360.0 / STRIP_COLUMNS


def segment_kind(scores: SegmentScores, thresholds: Thresholds) -> DefectKind | None:
    """Return the likeliest kind of defect of a segment, or None if it is good.

    A segment is good if no kind reaches its threshold and OK is likelier than each kind. Of two kinds as likely, the graver one is
    returned.
    """
    likeliest = max(scores.defects.values())
    over = any(scores.defects[limit.kind] >= limit.threshold for limit in thresholds.kinds)
    if not over and scores.ok > likeliest:
        return None
    return [limit.kind for limit in thresholds.kinds if scores.defects[limit.kind] == likeliest][-1]


def near_threshold(scores: SegmentScores, thresholds: Thresholds) -> bool:
    """Return whether a segment is neither clearly OK nor clearly NOK, so that a second look is worth its time."""
    pairs = ((scores.defects[limit.kind], limit.threshold) for limit in thresholds.kinds)
    return any(t / 8 <= p < 1 - (1 - t) / 8 for p, t in pairs)


def mean_of(views: Sequence[SegmentScores]) -> SegmentScores:
    """Return the scores of a segment that was seen more than once: the geometric mean, scaled to add up to 1 again."""
    kinds = list(views[0].defects)
    rows = [[log(max(p, 1e-9)) for p in (view.ok, *(view.defects[kind] for kind in kinds))] for view in views]
    means = [exp(sum(column) / len(views)) for column in zip(*rows, strict=True)]
    total = reduce(add, means)  # left to right: the same bits on every version of Python
    return SegmentScores(
        means[0] / total, {kind: mean / total for kind, mean in zip(kinds, means[1:], strict=True)}
    )


def findings(
    scores: Sequence[SegmentScores],
    maps: Map,
    mapped: Sequence[DefectKind],
    thresholds: Thresholds,
    ring: Ring,
    um_per_px: float,
) -> tuple[Finding, ...]:
    """Return the defects of the whole weld: the map's areas that reach into a rejected segment of their kind, across crops and seam.

    `maps` (21, C, 32, 32) float32, one channel for each of the C kinds in `mapped`. A rejected segment whose map shows nothing is a
    finding of its own, with the segment's angles and neither width nor area; neighbours of one kind are one finding. So every
    rejected segment lies in a finding. Raises ValueError unless there are 21 segments.
    """
    kinds = [segment_kind(s, thresholds.of_segment(i)) for i, s in enumerate(scores)]
    if len(kinds) != SEGMENTS or maps.shape[0] != SEGMENTS:
        raise ValueError(f"{len(kinds)} segments with {maps.shape[0]} maps, needed {SEGMENTS}")
    found: list[Finding] = []
    unseen: list[DefectKind | None] = list(kinds)
    for channel, kind in zip(whole_map(maps), mapped, strict=True):
        if kind not in kinds:
            continue
        for extent in extents(channel, kind.joins_mm * 1000 / um_per_px):
            if any(kinds[s] == kind for s in extent.segments):
                found.append(_measured(kind, extent, scores, ring, um_per_px))
                unseen = [None if s in extent.segments and k == kind else k for s, k in enumerate(unseen)]
    found += _whole_segments(unseen, scores, ring, um_per_px)
    return tuple(sorted(found, key=lambda f: f.start_deg))


def rejected_kinds(
    scores: Sequence[SegmentScores], found: Sequence[Finding], thresholds: Thresholds
) -> tuple[Reason | None, ...]:
    """Return for each segment the kind of defect that rejects it: over its threshold, and not for tolerated findings alone."""
    kinds = [segment_kind(s, thresholds.of_segment(i)) for i, s in enumerate(scores)]
    return tuple(
        None if kind is None or _tolerated(i, kind, scores[i], found, thresholds) else kind.reason
        for i, kind in enumerate(kinds)
    )


def _tolerated(
    index: int, kind: DefectKind, scores: SegmentScores, found: Sequence[Finding], thresholds: Thresholds
) -> bool:
    """Return whether all of a kind in a segment and its neighbours was measured and is together shorter than the minimum length.

    Never true where another kind is over its threshold: the map was not asked for that kind.
    """
    limits = thresholds.of_segment(index).kinds
    if any(scores.defects[limit.kind] >= limit.threshold for limit in limits if limit.kind != kind):
        return False
    start, end = index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG
    of_kind = [f for f in found if f.kind is kind.reason]
    near = [f for f in of_kind if _reaches(f, start - SEGMENT_DEG, end + SEGMENT_DEG)]
    if not any(_reaches(f, start, end) for f in of_kind) or any(f.area_mm2 is None for f in near):
        return False
    return sum(max(f.length_mm, f.width_mm or 0.0) for f in near) < thresholds.of(kind).min_mm


def _reaches(finding: Finding, start_deg: float, end_deg: float) -> bool:
    return any(
        finding.start_deg < end_deg + turn and finding.end_deg > start_deg + turn
        for turn in (-360.0, 0.0, 360.0)
    )


def _measured(
    kind: DefectKind, extent: Extent, scores: Sequence[SegmentScores], ring: Ring, um_per_px: float
) -> Finding:
    """Measure an area of the map; its length is taken along the weld at the defect's own radius."""
    mm_per_px = um_per_px / 1000
    radius_px = ring.radius_px + STRIP_ROWS / 2 - (extent.top_px + extent.bottom_px) / 2
    columns = extent.end_px - extent.start_px
    stretch = radius_px * 2 * pi / STRIP_COLUMNS
    width_px = (
        extent.bottom_px - extent.top_px if kind.width is Width.EDGE_TO_EDGE else extent.area_px2 / columns
    )
    return Finding(
        kind=kind.reason,
        start_deg=extent.start_px * DEG_PER_PX,
        end_deg=extent.end_px * DEG_PER_PX,
        length_mm=columns * stretch * mm_per_px,
        score=max(scores[s].nok for s in extent.segments),
        width_mm=width_px * mm_per_px,
        area_mm2=extent.area_px2 * stretch * mm_per_px**2,
    )


def _whole_segments(
    kinds: Sequence[DefectKind | None], scores: Sequence[SegmentScores], ring: Ring, um_per_px: float
) -> list[Finding]:
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
            found.append(
                Finding(kind.reason, start * SEGMENT_DEG, (start + length) * SEGMENT_DEG, arc_mm, score)
            )
    return found

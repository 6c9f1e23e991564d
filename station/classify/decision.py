"""Decides by scores, defect maps and limits on the findings and rejected segments of a weld; pure."""

from collections.abc import Sequence
from functools import reduce
from math import exp, log, pi
from operator import add

from station.classify.extent import Extent, Map, extents, whole_map
from station.classify.thresholds import Thresholds
from station.defects import DefectKind, Reason, Width
from station.domain import (
    NETWORK_UM_PER_PX,
    SEGMENT_DEG,
    SEGMENTS,
    STRIP_COLUMNS,
    STRIP_ROWS,
    Finding,
    Ring,
    SegmentScores,
)

DEG_PER_PX = 360.0 / STRIP_COLUMNS
"""Angle of one column of the strip."""


def segment_kind(scores: SegmentScores, thresholds: Thresholds) -> DefectKind | None:
    """Return the most likely kind of defect of a segment, or None if the segment is good.

    A segment is good if no kind reaches its threshold and OK is more likely than every kind. If two kinds are
    equally likely, the more severe one is returned.
    """
    likeliest = max(scores.defects.values())
    over = any(scores.defects[limit.kind] >= limit.threshold for limit in thresholds.kinds)
    if not over and scores.ok > likeliest:
        return None
    return [limit.kind for limit in thresholds.kinds if scores.defects[limit.kind] == likeliest][-1]


def near_threshold(scores: SegmentScores, thresholds: Thresholds) -> bool:
    """Return whether a segment is neither clearly OK nor clearly NOK, and so worth judging again."""
    pairs = ((scores.defects[limit.kind], limit.threshold) for limit in thresholds.kinds)
    return any(threshold / 8 <= score < 1 - (1 - threshold) / 8 for score, threshold in pairs)


def mean_of(views: Sequence[SegmentScores]) -> SegmentScores:
    """Return the scores of a segment that was judged several times: geometric mean, scaled to a sum of 1."""
    kinds = list(views[0].defects)
    rows = [
        [log(max(score, 1e-9)) for score in (view.ok, *(view.defects[kind] for kind in kinds))]
        for view in views
    ]
    means = [exp(sum(column) / len(views)) for column in zip(*rows, strict=True)]
    total = reduce(
        add, means
    )  # summed from left to right, which gives the same bits on every version of Python
    return SegmentScores(
        means[0] / total, {kind: mean / total for kind, mean in zip(kinds, means[1:], strict=True)}
    )


def findings(
    scores: Sequence[SegmentScores],
    maps: Map,
    mapped: Sequence[DefectKind],
    thresholds: Thresholds,
    *,
    ring: Ring,
    um_per_px: float,
) -> tuple[Finding, ...]:
    """Return the findings of the whole weld, in order of their start angle.

    `maps` (21, C, 32, 32) float32 has one channel for each of the C kinds in `mapped`. A finding is an area
    of the map that reaches into a segment with a defect of its kind; it may cross crops and angle 0. A
    segment with a defect whose map shows nothing is a finding too, with the angles of the segment and neither
    width nor area; neighbours of one kind are one finding. So every segment with a defect lies in a finding.
    Raises ValueError unless there are 21 segments.
    """
    kinds = [segment_kind(own, thresholds.of_segment(i)) for i, own in enumerate(scores)]
    if len(kinds) != SEGMENTS or maps.shape[0] != SEGMENTS:
        raise ValueError(f"{len(kinds)} segments and {maps.shape[0]} maps, but {SEGMENTS} of each are needed")
    found: list[Finding] = []
    unseen: list[DefectKind | None] = list(kinds)
    for channel, kind in zip(whole_map(maps), mapped, strict=True):
        if kind not in kinds:
            continue
        for extent in extents(channel, kind.joins_mm * 1000 / NETWORK_UM_PER_PX):
            if any(kinds[index] == kind for index in extent.segments):
                score = max(scores[index].nok for index in extent.segments)
                found.append(_measured(kind, extent, score, ring=ring, um_per_px=um_per_px))
                unseen = [
                    None if index in extent.segments and own == kind else own
                    for index, own in enumerate(unseen)
                ]
    found += _whole_segments(unseen, scores, ring, um_per_px)
    return tuple(sorted(found, key=lambda finding: finding.start_deg))


def rejected_kinds(
    scores: Sequence[SegmentScores], found: Sequence[Finding], thresholds: Thresholds
) -> tuple[Reason | None, ...]:
    """Return for each segment the kind of defect for which it is rejected, or None.

    A segment is rejected for a kind that is over its threshold, unless all its findings are tolerated.
    """
    kinds = [segment_kind(own, thresholds.of_segment(i)) for i, own in enumerate(scores)]
    return tuple(
        None
        if kind is None or _tolerated(kind, i, scores=scores[i], found=found, thresholds=thresholds)
        else kind.reason
        for i, kind in enumerate(kinds)
    )


def _tolerated(
    kind: DefectKind, index: int, *, scores: SegmentScores, found: Sequence[Finding], thresholds: Thresholds
) -> bool:
    """Return whether the findings of a kind in a segment and its neighbours are below the minimum length.

    Their lengths are added, and all must have been measured. Returns False if another kind is over its
    threshold too, because the map of that kind was not evaluated.
    """
    limits = thresholds.of_segment(index).kinds
    if any(scores.defects[limit.kind] >= limit.threshold for limit in limits if limit.kind != kind):
        return False
    start, end = index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG
    of_kind = [finding for finding in found if finding.kind is kind.reason]
    near = [finding for finding in of_kind if _reaches(finding, start - SEGMENT_DEG, end + SEGMENT_DEG)]
    if not any(_reaches(finding, start, end) for finding in of_kind):
        return False
    if any(finding.area_mm2 is None for finding in near):
        return False
    return sum(max(own.length_mm, own.width_mm or 0.0) for own in near) < thresholds.of(kind).min_mm


def _reaches(finding: Finding, start_deg: float, end_deg: float) -> bool:
    return any(
        finding.start_deg < end_deg + turn and finding.end_deg > start_deg + turn
        for turn in (-360.0, 0.0, 360.0)
    )


def _measured(kind: DefectKind, extent: Extent, score: float, *, ring: Ring, um_per_px: float) -> Finding:
    """Return an area of the map as a finding; its length is measured at the radius of the defect."""
    mm_per_px = NETWORK_UM_PER_PX / 1000
    ring_px = ring.radius_px * (um_per_px / NETWORK_UM_PER_PX)  # in rows of the strip, as the extent is
    radius_px = ring_px + STRIP_ROWS / 2 - (extent.top_px + extent.bottom_px) / 2
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
        score=score,
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
                Finding(
                    kind=kind.reason,
                    start_deg=start * SEGMENT_DEG,
                    end_deg=(start + length) * SEGMENT_DEG,
                    length_mm=arc_mm,
                    score=score,
                )
            )
    return found

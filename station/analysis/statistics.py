"""Statistics of many parts; pure."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime

from station.analysis.worst_segment import worst_segment
from station.domain import SEGMENTS, Purpose, SegmentQuality, Verdict
from station.records import Record

SHIFTS_H = (6, 14, 22)
"""Local hours at which shifts begin; the third runs over midnight."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """Values of one part in the trends."""

    number: int
    """Inspection number of the part."""
    verdict: Verdict
    worst: float | None
    """Highest score of NOK."""
    mean_dn: float | None
    sharpness: float | None
    saturated: float | None
    """Fraction of saturated pixels."""
    novelty: float | None
    worst_segment: SegmentQuality | None
    """Worst value of each kind among the segments."""
    cycle_ms: float
    """Time for grabbing and inspecting the part."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Counts of the parts of one shift and recipe."""

    shift: str
    """Day and number of the shift, such as 2026-11-22 / 2."""
    recipe: int
    ok: int
    nok: int
    error: int

    @property
    def yield_share(self) -> float:
        """Fraction of OK parts among all parts, including those that were not judged."""
        return self.ok / (self.ok + self.nok + self.error)


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """Summary of many parts."""

    groups: tuple[Group, ...]
    """Counts per shift and recipe, latest shift first."""
    reasons: tuple[tuple[str, int], ...]
    """Reasons with their counts, most frequent first."""
    segments: tuple[int, ...]
    """Number of rejections of each of the 21 segments."""
    points: tuple[Point, ...]
    """Values of the parts in order of their numbers."""
    thresholds: tuple[float, ...]
    """Thresholds of the newest part."""


def shift_of(when: datetime) -> str:
    """Return day and number of the shift of a local time; a night shift belongs to the day it began on."""
    hour = when.hour
    number = sum(hour >= start for start in SHIFTS_H)
    day = when.toordinal() - (number == 0)
    return f"{datetime.fromordinal(day):%Y-%m-%d} / {number or len(SHIFTS_H)}"


def summarise(records: Iterable[Record]) -> Summary:
    """Return the summary of all records of parts; masters and test images do not count."""
    counts: dict[tuple[str, int], Counter[Verdict]] = {}
    reasons: Counter[str] = Counter()
    segments, points, newest = [0] * SEGMENTS, [], None
    for record in records:
        if record.purpose is not Purpose.PART:
            continue
        inspection, timing, quality = record.inspection, record.inspection.timing, record.inspection.quality
        newest = record if newest is None or record.inspection_id > newest.inspection_id else newest
        key = (shift_of(record.grabbed_at.astimezone()), record.provenance.recipe)
        counts.setdefault(key, Counter())[record.verdict] += 1
        if inspection.reason is not None:
            reasons[str(inspection.reason)] += 1
        for index, kind in enumerate(inspection.rejected):
            segments[index] += kind is not None
        steps_ms = (timing.grab_ms, timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
        points.append(
            Point(
                number=record.inspection_id,
                verdict=record.verdict,
                worst=inspection.worst,
                mean_dn=None if quality is None else quality.mean_dn,
                sharpness=None if quality is None else quality.sharpness,
                saturated=None if quality is None else quality.saturated_share,
                novelty=inspection.novelty,
                worst_segment=worst_segment(inspection),
                cycle_ms=sum(ms for ms in steps_ms if ms is not None),
            )
        )
    groups = (
        Group(
            shift=shift,
            recipe=recipe,
            ok=count[Verdict.OK],
            nok=count[Verdict.NOK],
            error=count[Verdict.ERROR],
        )
        for (shift, recipe), count in sorted(counts.items(), reverse=True)
    )
    limits = () if newest is None else tuple(limit.threshold for limit in newest.provenance.thresholds.kinds)
    return Summary(
        groups=tuple(groups),
        reasons=tuple(reasons.most_common()),
        segments=tuple(segments),
        points=tuple(sorted(points, key=lambda point: point.number)),
        thresholds=limits,
    )

"""What many parts say together; pure."""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime

from station.domain import SEGMENTS, Purpose, Verdict
from station.records import Record

SHIFTS_H = (6, 14, 22)
"""Local hours at which shifts begin; the third runs over midnight."""


@dataclass(frozen=True, slots=True)
class Point:
    """One part in the trends."""

    number: int
    verdict: Verdict
    worst: float | None
    """Highest score of NOK."""
    mean_dn: float | None
    sharpness: float | None
    saturated: float | None
    """Share of the pixels."""
    novelty: float | None
    cycle_ms: float


@dataclass(frozen=True, slots=True)
class Group:
    """Parts of one shift and recipe."""

    shift: str
    """Day and number, as 2026-11-22 / 2."""
    recipe: int
    ok: int
    nok: int
    error: int

    @property
    def yield_share(self) -> float:
        """OK of all parts, also of those not judged."""
        return self.ok / (self.ok + self.nok + self.error)


@dataclass(frozen=True, slots=True)
class Summary:
    """All of it."""

    groups: tuple[Group, ...]
    reasons: tuple[tuple[str, int], ...]
    """The most frequent first."""
    segments: tuple[int, ...]
    """How often each of the 21 was refused."""
    points: tuple[Point, ...]
    """In order of the numbers."""
    thresholds: tuple[float, ...]
    """Of the newest part."""


def shift_of(when: datetime) -> str:
    """Day and number of the shift of a local time; after midnight it is still the day before."""
    hour = when.hour
    number = sum(hour >= start for start in SHIFTS_H)
    day = when.toordinal() - (number == 0)
    return f"{datetime.fromordinal(day):%Y-%m-%d} / {number or len(SHIFTS_H)}"


def summarise(records: Iterable[Record]) -> Summary:
    """Of parts alone: masters and test pictures do not count."""
    counts: dict[tuple[str, int], Counter[Verdict]] = {}
    reasons: Counter[str] = Counter()
    segments, points, newest = [0] * SEGMENTS, [], None
    for record in records:
        if record.purpose is not Purpose.PART:
            continue
        inspection, t = record.inspection, record.inspection.timing
        newest = record if newest is None or record.inspection_id > newest.inspection_id else newest
        key = (shift_of(record.grabbed_at.astimezone()), record.provenance.recipe)
        counts.setdefault(key, Counter())[record.verdict] += 1
        if inspection.reason is not None:
            reasons[str(inspection.reason)] += 1
        for index, kind in enumerate(inspection.rejected):
            segments[index] += kind is not None
        q = inspection.quality
        points.append(
            Point(
                record.inspection_id,
                record.verdict,
                max((s.nok for s in inspection.scores), default=None),
                None if q is None else q.mean_dn,
                None if q is None else q.sharpness,
                None if q is None else q.saturated_share,
                inspection.novelty,
                sum(ms for ms in (t.grab_ms, t.locate_ms, t.unwrap_ms, t.classify_ms) if ms is not None),
            )
        )
    groups = (
        Group(*key, c[Verdict.OK], c[Verdict.NOK], c[Verdict.ERROR])
        for key, c in sorted(counts.items(), reverse=True)
    )
    limits = () if newest is None else tuple(limit.threshold for limit in newest.provenance.thresholds.kinds)
    return Summary(
        tuple(groups),
        tuple(reasons.most_common()),
        tuple(segments),
        tuple(sorted(points, key=lambda p: p.number)),
        limits,
    )

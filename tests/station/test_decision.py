from hypothesis import given
from hypothesis import strategies as st

from station.classify.decision import Thresholds, findings, segment_kind
from station.domain import SEGMENT_DEG, SEGMENTS, Reason, SegmentScores

OK, HOLE, GONE = SegmentScores(0.98, 0.01, 0.01), SegmentScores(0.1, 0.8, 0.1), SegmentScores(0.1, 0.1, 0.8)
LIMITS = Thresholds(0.5, 0.5)


def row(**bad: SegmentScores) -> tuple[SegmentScores, ...]:
    return tuple(bad.get(f"s{i}", OK) for i in range(SEGMENTS))


def test_neighbours_merge_over_the_seam() -> None:
    (found,) = findings(row(s20=GONE, s0=GONE, s1=GONE), LIMITS, 5.5)
    assert (found.kind, found.start_deg, found.end_deg) == (Reason.MISSING_WELD, 20 * SEGMENT_DEG, 23 * SEGMENT_DEG)


def test_two_kinds_side_by_side_stay_two() -> None:
    found = findings(row(s4=HOLE, s5=GONE), LIMITS, 5.5)
    assert [f.kind for f in found] == [Reason.HOLE, Reason.MISSING_WELD]


def test_all_round_is_one_finding_of_the_whole_circumference() -> None:
    (found,) = findings((GONE,) * SEGMENTS, LIMITS, 5.0)
    assert (found.start_deg, found.end_deg) == (0.0, 360.0)
    assert abs(found.length_mm - 2 * 3.14159265 * 5.0) < 1e-3


def test_a_segment_not_likelier_ok_than_not_is_nok_whatever_the_thresholds() -> None:
    assert segment_kind(SegmentScores(0.3, 0.4, 0.3), Thresholds(0.9, 0.9)) is Reason.HOLE


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1)), min_size=SEGMENTS, max_size=SEGMENTS), st.floats(0.05, 0.95))
def test_no_findings_means_every_segment_is_below_its_threshold(raw: list[tuple[float, float, float]], limit: float) -> None:
    scores = tuple(SegmentScores(a / (a + b + c + 1e-9), b / (a + b + c + 1e-9), c / (a + b + c + 1e-9)) for a, b, c in raw)
    limits = Thresholds(limit, limit)
    found = findings(scores, limits, 5.5)
    covered = {i % SEGMENTS for f in found for i in range(round(f.start_deg / SEGMENT_DEG), round(f.end_deg / SEGMENT_DEG))}
    assert covered == {i for i, s in enumerate(scores) if segment_kind(s, limits) is not None}
    if not found:
        assert all(s.hole < limit and s.missing_weld < limit and s.ok > max(s.hole, s.missing_weld) for s in scores)

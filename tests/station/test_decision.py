from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.classify.decision import findings, mean_of, near_threshold, rejected_kinds, segment_kind
from station.classify.extent import CELL_PX, CELLS, Map
from station.defects import Reason, kind_named
from station.domain import SEGMENT_DEG, SEGMENTS, Finding, Ring, SegmentScores
from tests.parts import scores_of, thresholds

OK, HOLE, GONE = scores_of(0.98, 0.01, 0.01), scores_of(0.1, 0.8, 0.1), scores_of(0.1, 0.1, 0.8)
LIMITS = thresholds(0.5, 0.5)
RING = Ring(600.0, 600.0, 428.0, 1.0)
UM = 13.0
MAPPED = (kind_named("hole"), kind_named("missing_weld"))
"""Kinds of a network that knows these two, however many the station knows."""
BLIND = np.zeros((SEGMENTS, len(MAPPED), CELLS, CELLS), np.float32)


def row(**bad: SegmentScores) -> tuple[SegmentScores, ...]:
    return tuple(bad.get(f"s{i}", OK) for i in range(SEGMENTS))


def judged(scores: tuple[SegmentScores, ...], maps: Map = BLIND) -> tuple[Finding, ...]:
    return findings(scores, maps, MAPPED, LIMITS, ring=RING, um_per_px=UM)


def test_neighbours_the_map_is_blind_to_merge_over_the_seam() -> None:
    (found,) = judged(row(s20=GONE, s0=GONE, s1=GONE))
    assert (found.kind, found.start_deg, found.end_deg) == (
        Reason.MISSING_WELD,
        20 * SEGMENT_DEG,
        23 * SEGMENT_DEG,
    )
    assert found.width_mm is None
    assert found.area_mm2 is None


def test_two_kinds_side_by_side_stay_two() -> None:
    assert [f.kind for f in judged(row(s4=HOLE, s5=GONE))] == [Reason.HOLE, Reason.MISSING_WELD]


def test_all_round_is_one_finding_of_the_whole_circumference() -> None:
    (found,) = judged((GONE,) * SEGMENTS)
    assert (found.start_deg, found.end_deg) == (0.0, 360.0)
    assert found.length_mm == pytest.approx(2 * pi * 428 * 0.013, rel=1e-6)


def test_a_hole_is_measured_in_mm_at_its_own_radius() -> None:
    maps = BLIND.copy()
    maps[4, 0, 8:12, 10:20] = 1  # 16 px high, 40 columns long, above the middle: outside the centre line
    (found,) = judged(row(s4=HOLE), maps)
    radius_px = 428 + 64 - 10 * CELL_PX
    assert found.width_mm == pytest.approx(0.208)
    assert found.length_mm == pytest.approx(40 * 2 * pi * radius_px / 2688 * 0.013)
    assert found.area_mm2 == pytest.approx(found.width_mm * found.length_mm)
    assert found.start_deg == pytest.approx((4 * 128 + 40) * 360 / 2688)


def test_one_defect_over_two_crops_is_one_finding_also_over_the_seam() -> None:
    for left, right in ((4, 5), (20, 0)):
        maps = BLIND.copy()
        maps[left, 0, 14:18, 24:] = 1
        maps[right, 0, 14:18, :8] = 1
        (found,) = judged(row(**{f"s{left}": HOLE}), maps)  # the other half lies in a segment that passed
        assert found.end_deg - found.start_deg == pytest.approx(64 * 360 / 2688)


def test_a_map_in_a_segment_that_passed_is_no_finding() -> None:
    maps = BLIND.copy()
    maps[4, 0, 14:18, 10:14] = 1
    assert judged(row(), maps) == ()


def test_a_segment_not_likelier_ok_than_not_is_nok_whatever_the_thresholds() -> None:
    assert segment_kind(scores_of(0.3, 0.4, 0.3), thresholds(0.9, 0.9)) == MAPPED[0]


SCORES = st.lists(
    st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1)), min_size=SEGMENTS, max_size=SEGMENTS
)


@given(SCORES, st.floats(0.05, 0.95), st.integers(0, 2**31))
def test_every_refused_segment_lies_in_a_finding_and_without_one_none_is_refused(
    raw: list[tuple[float, float, float]], limit: float, seed: int
) -> None:
    scores = tuple(
        scores_of(a / (a + b + c + 1e-9), b / (a + b + c + 1e-9), c / (a + b + c + 1e-9)) for a, b, c in raw
    )
    rng = np.random.default_rng(seed)
    maps = np.asarray((rng.random(BLIND.shape) > 0.97) * rng.random(BLIND.shape), np.float32)
    limits = thresholds(limit, limit)
    found = findings(scores, maps, MAPPED, limits, ring=RING, um_per_px=UM)
    for index, s in enumerate(scores):
        if segment_kind(s, limits) is not None:
            start, end = index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG
            assert any(f.start_deg + k < end and f.end_deg + k > start for f in found for k in (-360, 0, 360))
    assert bool(found) == any(segment_kind(s, limits) is not None for s in scores)


@given(st.lists(st.floats(0, 1), min_size=1, max_size=4))
def test_several_looks_lie_between_the_best_and_the_worst(nok: list[float]) -> None:
    again = mean_of([scores_of(1 - p, p, 0.0) for p in nok])
    assert again.ok + sum(again.defects.values()) == pytest.approx(1)
    assert min(nok) - 1e-6 <= again.nok <= max(nok) + 1e-6


def test_clear_segments_get_no_second_look() -> None:
    assert not near_threshold(scores_of(0.98, 0.01, 0.01), LIMITS)
    assert not near_threshold(scores_of(0.01, 0.98, 0.01), LIMITS)
    assert near_threshold(scores_of(0.6, 0.39, 0.01), LIMITS)


def one_hole(columns: int) -> Map:
    """A hole of so many cells in segment 5 (index 4)."""
    maps = BLIND.copy()
    maps[4, 0, 14:18, 10 : 10 + columns] = 1
    return maps


@pytest.mark.parametrize(
    ("columns", "least_mm", "refused"), [(2, 0.0, True), (2, 0.3, False), (8, 0.3, True)]
)
def test_a_finding_shorter_than_the_least_length_is_told_and_tolerated(
    columns: int, least_mm: float, refused: bool
) -> None:
    limits = thresholds(0.5, 0.5, hole_mm=least_mm)
    found = findings(row(s4=HOLE), one_hole(columns), MAPPED, limits, ring=RING, um_per_px=UM)
    assert len(found) == 1
    kinds = rejected_kinds(row(s4=HOLE), found, limits)
    assert [i for i, kind in enumerate(kinds) if kind] == ([4] if refused else [])


def test_what_could_not_be_measured_or_stands_beside_something_greater_is_never_tolerated() -> None:
    limits = thresholds(0.5, 0.5, hole_mm=5.0, missing_mm=5.0)
    blind = findings(row(s4=HOLE, s9=GONE), BLIND, MAPPED, limits, ring=RING, um_per_px=UM)
    assert [i for i, kind in enumerate(rejected_kinds(row(s4=HOLE, s9=GONE), blind, limits)) if kind] == [
        4,
        9,
    ]
    maps = one_hole(2)
    maps[4, 0, 2:6, 20:30] = 1
    some = thresholds(0.5, 0.5, hole_mm=0.3)
    found = findings(row(s4=HOLE), maps, MAPPED, some, ring=RING, um_per_px=UM)
    assert len(found) == 2
    assert rejected_kinds(row(s4=HOLE), found, some)[4] is Reason.HOLE


def test_a_segment_may_have_a_limit_of_its_own() -> None:
    scores = row(s4=scores_of(0.7, 0.2, 0.1), s5=scores_of(0.7, 0.2, 0.1))
    limits = thresholds(0.5, 0.5, segments=((5, 0.15),))
    found = findings(scores, BLIND, MAPPED, limits, ring=RING, um_per_px=UM)
    assert [i for i, kind in enumerate(rejected_kinds(scores, found, limits)) if kind] == [4]


@given(SCORES, st.floats(0.05, 0.95), st.floats(0, 3), st.floats(0, 3), st.integers(0, 2**31))
def test_least_lengths_only_tolerate_and_without_them_every_segment_over_its_limit_is_refused(
    raw: list[tuple[float, float, float]], limit: float, hole_mm: float, missing_mm: float, seed: int
) -> None:
    scores = tuple(scores_of(a / s, b / s, c / s) for a, b, c in raw if (s := a + b + c) > 0.01)
    if len(scores) < SEGMENTS:
        return
    maps = np.random.default_rng(seed).beta(0.2, 1.0, BLIND.shape).astype(np.float32)
    strict, mild = thresholds(limit, limit), thresholds(limit, limit, (), hole_mm, missing_mm)
    over = tuple(None if (kind := segment_kind(s, strict)) is None else kind.reason for s in scores)
    assert (
        rejected_kinds(scores, findings(scores, maps, MAPPED, strict, ring=RING, um_per_px=UM), strict)
        == over
    )
    kinds = rejected_kinds(scores, findings(scores, maps, MAPPED, mild, ring=RING, um_per_px=UM), mild)
    assert all(kind in (None, before) for kind, before in zip(kinds, over, strict=True))
    tolerated = [i for i, (kind, before) in enumerate(zip(kinds, over, strict=True)) if before and not kind]
    for i in tolerated:
        assert any(
            f.kind is over[i] and f.area_mm2 is not None
            for f in findings(scores, maps, MAPPED, mild, ring=RING, um_per_px=UM)
        )


def test_small_defects_side_by_side_and_long_ones_across_the_seam_are_not_small() -> None:
    limits = thresholds(0.5, 0.5, hole_mm=0.5)
    row_of_pores = BLIND.copy()
    for column in (2, 10, 18, 26):
        row_of_pores[4, 0, 14:18, column : column + 2] = 1  # each 0.1 mm long, 0.21 mm wide
    across = BLIND.copy()
    across[4, 0, 4:28, 14:16] = 1  # 0.1 mm along the weld, 1.2 mm across
    for maps in (row_of_pores, across):
        found = findings(row(s4=HOLE), maps, MAPPED, limits, ring=RING, um_per_px=UM)
        assert all(f.length_mm < 0.5 for f in found)
        assert rejected_kinds(row(s4=HOLE), found, limits)[4] is Reason.HOLE


def test_a_segment_over_both_limits_is_never_tolerated() -> None:
    """Its map is read for the likelier kind alone: a small hole must not hide a bare joint."""
    limits = thresholds(0.3, 0.3, hole_mm=0.5)
    both = row(s4=scores_of(0.02, 0.50, 0.48))
    maps = one_hole(2)
    maps[4, 1] = 1
    assert (
        rejected_kinds(both, findings(both, maps, MAPPED, limits, ring=RING, um_per_px=UM), limits)[4]
        is Reason.HOLE
    )

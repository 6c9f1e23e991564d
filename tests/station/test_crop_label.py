"""Which kind of defect a crop shows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.classify.crop_label import MIN_OVERLAP, OK, Span, crop_label
from station.defects import KINDS
from station.domain import SEGMENT_DEG, SEGMENTS

ANGLES = st.floats(0, 720)
SPANS = st.lists(
    st.builds(
        lambda kind, at, length: (kind, at, at + length),
        st.sampled_from([kind.name for kind in KINDS]),
        st.floats(-360, 360),
        st.floats(0.5, 359.0),
    ),
    max_size=5,
)


@pytest.mark.parametrize(
    ("spans", "expected"),
    [
        ([], OK),
        ([("hole", 5.0, 6.0)], "hole"),
        ([("hole", 20.0, 21.0)], OK),
        ([("hole", 9.9, 20.0)], None),
        ([("hole", 7.9, 20.0)], "hole"),
        ([("hole", 365.0, 366.0)], "hole"),
        ([("hole", -1.0, 1.0)], "hole"),
        ([("hole", 359.0, 361.0)], "hole"),
        ([("missing_weld", 350.0, 365.0)], "missing_weld"),
        ([("missing_weld", 0.0, 360.0)], "missing_weld"),
        ([("missing_weld", 5.0, 6.0), ("hole", 2.0, 3.0)], "missing_weld"),
        ([("hole", 2.0, 3.0), ("missing_weld", 9.9, 30.0)], "hole"),
        ([("hole", 10.0, 20.0)], OK),
        ([("hole", 4.0, 4.0)], OK),
        ([("missing_weld", 5.0, 361.0)], "missing_weld"),
    ],
)
def test_the_crop_from_0_to_10_degrees(spans: list[Span], expected: str | None) -> None:
    assert crop_label(spans, 0.0, 10.0) == expected


def test_the_graver_kind_is_the_later_one_of_the_given_order() -> None:
    spans = [("crack", 1.0, 3.0), ("hole", 5.0, 7.0)]
    assert crop_label(spans, 0.0, 10.0, order=("hole", "crack")) == "crack"
    assert crop_label(spans, 0.0, 10.0, order=("crack", "hole")) == "hole"


@given(SPANS, st.integers(0, SEGMENTS - 1), st.integers(-2, 2))
def test_whole_turns_change_nothing(spans: list[Span], segment: int, turns: int) -> None:
    start, end = segment * SEGMENT_DEG, (segment + 1) * SEGMENT_DEG
    moved = [(kind, first + 360 * turns, last + 360 * turns) for kind, first, last in spans]
    measured = [_covered(span, start, end) for span in spans]
    if any(abs(v - limit) < 1e-3 for v, limit in measured):
        return
    assert crop_label(moved, start, end) == crop_label(spans, start, end)


@given(SPANS, st.integers(0, SEGMENTS - 1))
def test_it_agrees_with_counting_fine_steps(spans: list[Span], segment: int) -> None:
    start, end = segment * SEGMENT_DEG, (segment + 1) * SEGMENT_DEG
    measured = [_covered(span, start, end) for span in spans]
    if any(abs(v - limit) < 0.03 or 0 < v < 0.03 for v, limit in measured):
        return
    shown = [span[0] for span, (v, limit) in zip(spans, measured, strict=True) if v > limit]
    order = [kind.name for kind in KINDS]
    expected = max(shown, key=order.index) if shown else None if any(v for v, _ in measured) else OK
    assert crop_label(spans, start, end) == expected


def _covered(span: Span, start: float, end: float) -> tuple[float, float]:
    """Return the covered degrees of the arc by counting, and how many it takes."""
    at = np.linspace(start, end, 4001)
    _, first, last = span
    inside = (at - first) % 360 <= last - first
    return float(inside.mean() * (end - start)), MIN_OVERLAP * min(last - first, end - start)

"""Which kind of defect a crop shows: the rule for training data, rendered and real."""

from collections.abc import Iterable, Sequence

from station.defects import KINDS

OK = "ok"
"""Name of the crops without a defect."""
MIN_OVERLAP = 0.2
"""A crop shows a defect if this fraction of the shorter of the two is covered; with less it is not used."""
TOUCH_DEG = 1e-6
"""Overlap up to which a crop counts as free of a defect: rounding errors."""

ORDER = tuple(defect.name for defect in KINDS)
"""Names of the kinds of defect, the graver later."""

Span = tuple[str, float, float]
"""Name of the kind of defect, start and end in degrees; the end may exceed 360."""


def crop_label(
    spans: Iterable[Span],
    start_deg: float,
    end_deg: float,
    *,
    order: Sequence[str] = ORDER,
) -> str | None:
    """Return what the crop of an arc shows: the gravest kind of defect, "ok", or None if unused.

    A crop that a defect only just touches is neither. `order` names the kinds of defect, the graver later.
    """
    shown: list[str] = []
    is_touched = False
    width = end_deg - start_deg
    for kind, first, last in spans:
        length = last - first
        overlap = _overlap_deg(first - start_deg, length, width)
        if overlap >= MIN_OVERLAP * max(min(width, length), 1e-9):
            shown.append(kind)
        elif overlap > TOUCH_DEG:
            is_touched = True
    if shown:
        return max(shown, key=order.index)
    return None if is_touched else OK


def _overlap_deg(first: float, length: float, width: float) -> float:
    """Return how much of the arc from 0 to `width` an arc from `first` on covers, round the ring."""
    if length >= 360:
        return width
    first %= 360
    ahead = max(0.0, min(first + length, width) - first)
    round_the_ring = max(0.0, min(first + length - 360, width))
    return ahead + round_the_ring

"""Labels a crop with the kind of defect that it shows: the rule for rendered and real training data."""

from collections.abc import Iterable, Sequence

from station.defects import KINDS

OK = "ok"
"""Label of a crop without a defect."""
MIN_OVERLAP = 0.2
"""Minimum overlap of crop and defect, as a fraction of the shorter of the two, for the crop to show the
defect; a crop with less overlap is not used."""
TOUCH_DEG = 1e-6
"""Maximum overlap of a crop that counts as free of a defect; allows for rounding errors."""

ORDER = tuple(defect.name for defect in KINDS)
"""Names of the kinds of defect by increasing severity."""

Span = tuple[str, float, float]
"""Name of the kind of defect, start and end in degrees; the end may exceed 360."""


def crop_label(
    spans: Iterable[Span],
    start_deg: float,
    end_deg: float,
    *,
    order: Sequence[str] = ORDER,
) -> str | None:
    """Return the label of the crop of an arc: the most severe kind of defect, "ok", or None (not used).

    A crop that a defect only just touches is not used. `order` lists the kinds of defect by increasing
    severity.
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
    """Return the overlap of the arc from 0 to `width` with an arc of `length` that starts at `first`."""
    if length >= 360:
        return width
    first %= 360
    ahead = max(0.0, min(first + length, width) - first)
    round_the_ring = max(0.0, min(first + length - 360, width))
    return ahead + round_the_ring

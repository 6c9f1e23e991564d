"""The worst segment of a part in each value of its image quality, so that dirt shows early; pure."""

from station.domain import Inspection, SegmentQuality

WORST = {
    "mean_dn": min,
    "dark_fraction": max,
    "saturated_fraction": max,
    "contrast": min,
    "sharpness": min,
    "fine_structure": min,
    "weld": min,
    "visible": min,
}
"""Fields of SegmentQuality, and whether the smallest or the largest value is the worst."""


def worst_segment(inspection: Inspection) -> SegmentQuality | None:
    """Return the worst value of each kind among the segments of a part; None if none was measured.

    The values can be those of different segments.
    """
    if not inspection.segment_quality:
        return None
    worst: dict[str, float | None] = {}
    for name, end in WORST.items():
        values = [getattr(quality, name) for quality in inspection.segment_quality]
        worst[name] = end((value for value in values if value is not None), default=None)
    return SegmentQuality(**worst)  # type: ignore[arg-type]  # only `visible` can be None

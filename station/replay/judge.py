"""Reads one image and judges it like the line."""

from collections.abc import Sequence

import cv2
import numpy as np

from station.domain import Image, Inspection, Verdict
from station.errors import ImageError
from station.files.image import read_marked
from station.inspection.inspector import Inspector
from station.replay.files import Source
from station.replay.replayed import Circle, Replayed


def judge_image(inspector: Inspector, source: Source, factor: float) -> Replayed:
    """Read an image, scale it by `factor` to the scale of the settings, and inspect it."""
    try:
        image, warnings = read_marked(source.path)
    except ImageError as error:
        return _not_inspected(source, str(error))
    try:
        inspection = inspector.inspect(at_scale(image, factor))
    except Exception as error:  # noqa: BLE001 - one bad image must not stop the others
        text = str(error).splitlines()[0][:100] if str(error) else ""
        return _not_inspected(source, f"{source.path}: could not be judged ({type(error).__name__}: {text})")
    return as_replayed(source.name, inspection, factor, [f"{source.path}: {warning}" for warning in warnings])


def at_scale(image: Image, factor: float) -> Image:
    """Return `image` (height, width) uint8 scaled by `factor`."""
    if factor == 1:
        return image
    method = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, None, fx=factor, fy=factor, interpolation=method), np.uint8)


def as_replayed(name: str, inspection: Inspection, factor: float, warnings: Sequence[str] = ()) -> Replayed:
    """Return the result of inspecting an image that was scaled by `factor`."""
    timing = inspection.timing
    steps = (timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
    return Replayed(
        name=name,
        verdict=inspection.verdict,
        reason=None if inspection.reason is None else str(inspection.reason),
        circle=_circle(inspection, factor),
        scores=() if inspection.worst is None else inspection.nok_scores,
        findings=inspection.findings,
        novelty=inspection.novelty,
        detail=inspection.detail,
        unseen=inspection.unseen,
        segment_quality=inspection.segment_quality,
        inspection_ms=sum(ms for ms in steps if ms is not None),
        warnings=tuple(warnings),
    )


def _circle(inspection: Inspection, factor: float) -> Circle | None:
    ring = inspection.ring
    if ring is None:
        return None
    if factor == 1:
        return Circle(ring.center_x_px, ring.center_y_px, ring.radius_px)
    # resizing keeps the borders of the image in place, not the centres of its pixels
    x, y = ((center + 0.5) / factor - 0.5 for center in (ring.center_x_px, ring.center_y_px))
    return Circle(x, y, ring.radius_px / factor)


def _not_inspected(source: Source, why: str) -> Replayed:
    return Replayed(name=source.name, verdict=Verdict.ERROR, reason=why)

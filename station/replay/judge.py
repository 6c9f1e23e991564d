"""One image to its entry in the report."""

import dataclasses
from dataclasses import asdict, dataclass
from typing import Any

import cv2
import numpy as np

from station.domain import SEGMENTS, Image, Inspection
from station.errors import ImageError
from station.files.image import read_marked
from station.inspection.inspector import Inspector
from station.replay.files import Source


@dataclass(frozen=True, slots=True)
class Outcome:
    """What became of one image."""

    name: str
    entry: dict[str, Any]
    problem: str | None = None
    """Why it could not be read."""
    warnings: tuple[str, ...] = ()


def judge_image(inspector: Inspector, source: Source, factor: float) -> Outcome:
    """Read, make larger by `factor`, which brings it to the scale of the settings, inspect."""
    try:
        image, warnings = read_marked(source.path)
    except ImageError as error:
        return Outcome(source.name, _error(str(error)), str(error))
    try:
        inspection = inspector.inspect(at_scale(image, factor))
    except Exception as error:  # noqa: BLE001 - one image must not end the others
        why = f"{source.path}: could not be judged ({type(error).__name__}: {str(error).splitlines()[0][:100] if str(error) else ''})"
        return Outcome(source.name, _error(why), why)
    return Outcome(source.name, entry(inspection, factor), None, tuple(f"{source.path}: {w}" for w in warnings))


def at_scale(image: Image, factor: float) -> Image:
    """`image` (H, W) uint8 made larger by `factor`."""
    if factor == 1:
        return image
    method = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, None, fx=factor, fy=factor, interpolation=method), np.uint8)


def _error(why: str) -> dict[str, Any]:
    return {"verdict": "ERROR", "reason": why, "segments": [None] * SEGMENTS, "findings": []}


def entry(inspection: Inspection, factor: float = 1.0) -> dict[str, Any]:
    """An inspection in the replay format: pixels of the input image, angle 0 at +x, clockwise as seen."""
    ring, timing = inspection.ring, inspection.timing
    steps = (timing.locate_ms, timing.unwrap_ms, timing.classify_ms)
    if ring is not None and factor != 1:  # OpenCV keeps the borders of the picture in place, not the middles of its pixels
        x, y = ((c + 0.5) / factor - 0.5 for c in (ring.center_x_px, ring.center_y_px))
        ring = dataclasses.replace(ring, center_x_px=x, center_y_px=y, radius_px=ring.radius_px / factor)
    return {
        "center": None if ring is None else [ring.center_x_px, ring.center_y_px],
        "radius": None if ring is None else ring.radius_px,
        "verdict": str(inspection.verdict),
        "reason": None if inspection.reason is None else str(inspection.reason),
        "segments": [s.nok for s in inspection.scores] or [None] * SEGMENTS,
        "unwrap_start_deg": 0.0,
        "direction": "cw",
        "findings": [{**asdict(f), "kind": str(f.kind)} for f in inspection.findings],
        "novelty": inspection.novelty,
        "inspection_ms": sum(ms for ms in steps if ms is not None),
    }

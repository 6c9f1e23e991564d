"""Exact labels of rendered parts by the camera equation (paper, section 4.3, eq. 5).

Convention: angle 0 = +x (right), clockwise as seen in the image, [start, end] in degrees, end may exceed 360;
pixels (x, y) of the given image, centre of its top left pixel at (0, 0); mm on the object.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.draw import polygon

from station.domain import STRIP_COLUMNS, STRIP_ROWS, Ring
from station.vision.unwrap import frame_to_strip
from synth.camera.optics import Optics
from synth.camera.projection import project, ring_px
from synth.part.defect import Defect
from synth.part.part import Part
from synth.surface.contour import contour

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """Border of a defect in frame pixels: points (K, 2) as (x, y), closed; `kind` is the name of its kind."""

    kind: str
    points: Array
    start_deg: float
    end_deg: float


def outlines(part: Part, optics: Optics) -> list[Outline]:
    """Return the border of each of the part's defects."""
    if not part.defects:
        return []
    borders = contour(part, part.geometry.angles())
    return [
        Outline(defect.kind, project(part, optics, *defect.outline(borders)), *defect.span_deg(part.bead))
        for defect in part.defects
    ]


def mask(points: Array, width: int, height: int) -> NDArray[np.bool_]:
    """Return the pixels (height, width) whose centres an outline (K, 2) in pixels of that image encloses."""
    image = np.zeros((height, width), bool)
    image[polygon(points[:, 1], points[:, 0], image.shape)] = True  # type: ignore[no-untyped-call]
    return image


def strip_mask(
    outline: Outline, ring: Ring, origin_px: tuple[int, int], *, um_per_px: float
) -> NDArray[np.bool_]:
    """Return the mask (128, 2688) of a defect on the strip, across the seam too."""
    points = frame_to_strip(ring, outline.points - origin_px, um_per_px=um_per_px)
    points[:, 0] = np.unwrap(points[:, 0], period=STRIP_COLUMNS)
    if outline.end_deg - outline.start_deg >= 360:
        half = len(points) // 2
        points[half:, 0] += STRIP_COLUMNS * np.round((points[half - 1, 0] - points[half, 0]) / STRIP_COLUMNS)
    found = np.zeros((STRIP_ROWS, STRIP_COLUMNS), bool)
    for turn in range(-2, 3):
        found |= mask(points + np.array([turn * STRIP_COLUMNS, 0]), STRIP_COLUMNS, STRIP_ROWS)
    return found


def label(
    part: Part, optics: Optics, *, name: str, origin_px: tuple[int, int], size_px: tuple[int, int]
) -> dict[str, Any]:
    """Return the label of one image, JSON-ready.

    The image is the window `size_px` (width, height) at `origin_px` (x, y) of the frame.
    """
    x, y, radius = ring_px(part, optics)
    center = (x - origin_px[0], y - origin_px[1])
    return {
        "frame": name,
        "crop_origin": list(origin_px),
        "size": list(size_px),
        "center": [round(center[0], 3), round(center[1], 3)],
        "radius": round(radius, 3),
        "verdict": "OK" if part.kind is None else "NOK",
        "truth": "OK" if part.kind is None else part.kind,
        "defects": [
            _defect(defect, part, project(part, optics, *defect.extent(part.bead)) - origin_px, center)
            for defect in part.defects
        ],
        "seed": part.seed,
        "tilt_deg": [round(v, 3) for v in part.pose.tilt_deg],
        "weld_start_deg": round(part.bead.start_deg, 2),
        "bead_halfwidth_mm": round(part.bead.half_width_mm, 3),
    }


def _defect(defect: Defect, part: Part, points: Array, center: tuple[float, float]) -> dict[str, Any]:
    """Return the label of a defect whose extent has these points, in pixels of the image."""
    first, last = defect.span_deg(part.bead)
    if last - first >= 360:
        span = [0.0, 360.0]
    else:
        angle = np.rad2deg(np.arctan2(points[:, 1] - center[1], points[:, 0] - center[0]))
        ordered = np.sort(angle % 360)
        gaps = np.diff(np.append(ordered, ordered[0] + 360))
        start = float(ordered[(int(gaps.argmax()) + 1) % ordered.size])
        span = [round(start, 3), round(start + 360 - float(gaps.max()), 3)]
    length_mm, width_mm = defect.size_mm(part.bead)
    box = [*points.min(axis=0), *points.max(axis=0)]
    return {
        "kind": defect.kind,
        "angle_deg": span,
        "length_mm": round(length_mm, 3),
        "width_mm": round(width_mm, 3),
        "bbox_px": [round(float(v), 1) for v in box],
    }

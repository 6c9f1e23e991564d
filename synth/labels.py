"""Exact labels of a rendered part by the camera equation (paper, section 4.3, eq. 5).

Convention: angle 0 = +x (right), clockwise as seen in the image, [start, end] in degrees, end may exceed 360;
pixels (x, y) of the given image, centre of its top left pixel at (0, 0); mm on the object.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from skimage.measure import CircleModel

from synth.defects import outline
from synth.mesh import to_world
from synth.optics import Optics
from synth.part import Part, Truth

Array = NDArray[np.float64]


def ring_px(part: Part, optics: Optics) -> tuple[float, float, float]:
    """Centre x, y and radius in frame pixels: least-squares circle through the projected centre line."""
    angle = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    points = _project(part, optics, angle, np.full_like(angle, part.radius_mm))
    circle = CircleModel.from_estimate(points)  # type: ignore[no-untyped-call]
    x, y = circle.center
    return float(x), float(y), float(circle.radius)


def label(part: Part, optics: Optics, name: str, origin_px: tuple[int, int], size_px: tuple[int, int]) -> dict[str, Any]:
    """Label of one image: the window `size_px` (width, height) at `origin_px` (x, y) of the frame. JSON-ready."""
    x, y, radius = ring_px(part, optics)
    center = (x - origin_px[0], y - origin_px[1])
    defects = []
    for hole in part.holes:
        angle, radius_mm = outline(hole, part)
        points = _project(part, optics, angle, radius_mm) - origin_px
        defects.append(_defect(_hole_kind(hole.length_mm), points, center, hole.length_mm, hole.width_mm))
    for arc in part.missing:
        angle = np.deg2rad(np.linspace(arc.start_deg, arc.end_deg, 361))
        radii = part.radius_mm + part.half_width_mm * np.array([[-1.0], [1.0]])
        points = np.concatenate([_project(part, optics, angle, np.full_like(angle, r[0])) for r in radii]) - origin_px
        length_mm = float(np.deg2rad(arc.end_deg - arc.start_deg) * part.radius_mm)
        defects.append(_defect("missing_weld", points, center, length_mm, 2 * part.half_width_mm, arc.end_deg - arc.start_deg >= 360))
    return {
        "frame": name,
        "crop_origin": list(origin_px),
        "size": list(size_px),
        "center": [round(center[0], 3), round(center[1], 3)],
        "radius": round(radius, 3),
        "verdict": "OK" if part.truth is Truth.OK else "NOK",
        "truth": part.truth.value,
        "defects": defects,
        "seed": part.seed,
        "tilt_deg": [round(v, 3) for v in part.tilt_deg],
        "weld_start_deg": round(part.start_deg, 2),
        "bead_halfwidth_mm": round(part.half_width_mm, 3),
    }


def _hole_kind(length_mm: float) -> str:
    return "hole_small" if length_mm < 0.5 else "hole_long"


def _defect(
    kind: str, points: Array, center: tuple[float, float], length_mm: float, width_mm: float, all_round: bool = False
) -> dict[str, Any]:
    angle = np.rad2deg(np.arctan2(points[:, 1] - center[1], points[:, 0] - center[0]))
    if all_round:
        span = [0.0, 360.0]
    else:
        ordered = np.sort(angle % 360)
        gaps = np.diff(np.append(ordered, ordered[0] + 360))
        start = float(ordered[(int(gaps.argmax()) + 1) % ordered.size])
        span = [round(start, 3), round(start + 360 - float(gaps.max()), 3)]
    box = [*points.min(axis=0), *points.max(axis=0)]
    return {
        "kind": kind,
        "angle_deg": span,
        "length_mm": round(length_mm, 3),
        "width_mm": round(width_mm, 3),
        "bbox_px": [round(float(v), 1) for v in box],
    }


def _project(part: Part, optics: Optics, angle_rad: Array, radius_mm: Array) -> Array:
    points = np.stack([radius_mm * np.cos(angle_rad), radius_mm * np.sin(angle_rad), np.zeros_like(angle_rad)], axis=1)
    return optics.project(to_world(part, points))

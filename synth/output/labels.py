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
from synth.defects.hole import outline
from synth.part.part import MissingWeld, Part, Truth
from synth.surface.contour import contour

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Outline:
    """Border of a defect's opening in frame pixels: points (K, 2) as (x, y), closed; kind "hole" or "missing_weld"."""

    kind: str
    points: Array
    start_deg: float
    end_deg: float


def outlines(part: Part, optics: Optics) -> list[Outline]:
    """Openings in the weld: the holes, and the bare joint of each missing weld."""
    found = []
    for hole in part.holes:
        angle, radius_mm = outline(hole, part)
        half_deg = np.rad2deg(hole.length_mm / part.radius_mm / 2)
        found.append(Outline("hole", project(part, optics, angle, radius_mm), hole.angle_deg - half_deg, hole.angle_deg + half_deg))
    if part.missing:
        theta = part.geometry.angles()
        line = contour(part, theta)
        for arc in part.missing:
            angle, inner, outer = _along(part, arc, theta, line.joint_inner_mm, line.joint_outer_mm)
            edge = [project(part, optics, angle, outer), project(part, optics, angle, inner)[::-1]]
            found.append(Outline("missing_weld", np.concatenate(edge), arc.start_deg, arc.end_deg))
    return found


def _along(part: Part, arc: MissingWeld, theta: Array, *values: Array) -> tuple[Array, ...]:
    """Angles of an arc on the bead's grid, ends included, and values there."""
    if not part.geometry.is_closed:
        keep = (theta >= np.deg2rad(arc.start_deg)) & (theta <= np.deg2rad(arc.end_deg))
        return theta[keep], *(v[keep] for v in values)
    start, end = float(np.deg2rad(arc.start_deg)), float(np.deg2rad(arc.end_deg))
    angle = np.linspace(start, end, max(8, int((end - start) / (theta[1] - theta[0]))))
    return angle, *(np.interp(angle, theta, v, period=2 * np.pi) for v in values)


def mask(points: Array, width: int, height: int) -> NDArray[np.bool_]:
    """Pixels (height, width) whose centres an outline (K, 2) in pixels of that image encloses."""
    image = np.zeros((height, width), bool)
    image[polygon(points[:, 1], points[:, 0], image.shape)] = True  # type: ignore[no-untyped-call]
    return image


def strip_mask(outline: Outline, ring: Ring, origin_px: tuple[int, int]) -> NDArray[np.bool_]:
    """Mask (128, 2688) of an opening on the strip, across the seam too."""
    points = frame_to_strip(ring, outline.points - origin_px)
    points[:, 0] = np.unwrap(points[:, 0], period=STRIP_COLUMNS)
    if outline.end_deg - outline.start_deg >= 360:
        half = len(points) // 2
        points[half:, 0] += STRIP_COLUMNS * np.round((points[half - 1, 0] - points[half, 0]) / STRIP_COLUMNS)
    found = np.zeros((STRIP_ROWS, STRIP_COLUMNS), bool)
    for turn in range(-2, 3):
        found |= mask(points + np.array([turn * STRIP_COLUMNS, 0]), STRIP_COLUMNS, STRIP_ROWS)
    return found


def label(part: Part, optics: Optics, name: str, origin_px: tuple[int, int], size_px: tuple[int, int]) -> dict[str, Any]:
    """Label of one image: the window `size_px` (width, height) at `origin_px` (x, y) of the frame. JSON-ready.

    A missing weld's box holds the area where the bead should be.
    """
    x, y, radius = ring_px(part, optics)
    center = (x - origin_px[0], y - origin_px[1])
    defects = []
    for hole in part.holes:
        angle, radius_mm = outline(hole, part)
        points = project(part, optics, angle, radius_mm) - origin_px
        defects.append(_defect(_hole_kind(hole.length_mm), points, center, hole.length_mm, hole.width_mm))
    for arc in part.missing:
        angle = np.deg2rad(np.linspace(arc.start_deg, arc.end_deg, 361))
        radii = part.radius_mm + part.half_width_mm * np.array([[-1.0], [1.0]])
        points = np.concatenate([project(part, optics, angle, np.full_like(angle, r[0])) for r in radii]) - origin_px
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

"""Defects cut from the bead: masks on the polar grid, and their exact outlines.

Source: paper, section 3.5, eq. (3) for holes; arcs without weld are part of `topography.contour`.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.part import Hole, Part

Array = NDArray[np.float64]


def outline(hole: Hole, part: Part, points: int = 180) -> tuple[Array, Array]:
    """Outline of a hole as (angle_rad, radius_mm), each (points,): the deformed ellipse of eq. (3).

    The curve is scaled so that its bounding box is `length_mm` by `width_mm`.
    """
    x = np.linspace(0, 2 * np.pi, points, endpoint=False)
    d = hole.deformation * 0.35
    along = hole.a * np.cos(x) + d * np.sin(hole.a * x)
    across = hole.b * np.sin(x) + d * np.cos(hole.b * x)
    along = (along - (along.max() + along.min()) / 2) / np.ptp(along) * hole.length_mm
    across = (across - (across.max() + across.min()) / 2) / np.ptp(across) * hole.width_mm
    return np.deg2rad(hole.angle_deg) + along / part.radius_mm, part.radius_mm + hole.offset_mm + across


def hole_mask(part: Part, theta_rad: Array, center_mm: Array, half_mm: float, columns: int) -> NDArray[np.bool_]:
    """Mask (M, columns) over (angle, t in [-1, 1]) of the bead's grid: True where a hole is cut."""
    rows = theta_rad.size
    mask = np.zeros((rows, columns), np.uint8)
    for hole in part.holes:
        angle, radius = outline(hole, part)
        row = angle / (2 * np.pi) * rows
        column = ((radius - np.interp(angle % (2 * np.pi), theta_rad, center_mm)) / half_mm + 1) / 2 * (columns - 1)
        for turn in (-rows, 0, rows):
            polygon = np.stack([column, row + turn], axis=1)
            cv2.fillPoly(mask, [np.round(polygon * 256).astype(np.int32)], 1, shift=8)
    return mask.astype(bool)

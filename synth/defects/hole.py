"""Defects cut from the bead: masks on the polar grid, and their exact outlines.

Source: paper, section 3.5, eq. (3) for holes; arcs without weld are part of `contour`.
"""

import numpy as np
from numpy.typing import NDArray
from skimage.draw import polygon

from synth.part.part import Hole, Part
from synth.surface.contour import Contour

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


def hole_mask(part: Part, theta_rad: Array, line: Contour, columns: int) -> NDArray[np.bool_]:
    """Cells (M, columns) over (angle, t from -1 to 1) of the bead's grid: True where a hole is cut.

    Cell (m, n) lies between the grid's lines m and m + 1, n and n + 1; the last column is no cell.
    """
    rows = theta_rad.size
    mask = np.zeros((rows, columns), bool)
    step = theta_rad[1] - theta_rad[0]
    for hole in part.holes:
        angle, radius = outline(hole, part)
        center, inner, outer = (
            np.interp(angle, theta_rad, v, period=part.geometry.period_rad) for v in (line.center_mm, line.inner_mm, line.outer_mm)
        )
        t = np.where(radius > center, (radius - center) / (outer - center), (radius - center) / (center - inner))
        row, column = (angle - theta_rad[0]) / step - 0.5, (t + 1) / 2 * (columns - 1) - 0.5
        for turn in (-rows, 0, rows) if part.geometry.is_closed else (0,):
            mask[polygon(row + turn, column, mask.shape)] = True  # type: ignore[no-untyped-call]
    return mask

"""Border lines of bead and joint over the angle, and the cells of the bead's grid between them, mm."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skimage.draw import polygon

from synth.part.geometry import Geometry

Array = NDArray[np.float64]
Cells = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Borders:
    """Centre line, borders and joint of a weld; arrays of shape (M,) over `theta_rad`, mm."""

    geometry: Geometry
    theta_rad: Array
    center_mm: Array
    inner_mm: Array
    """Radius of the bead's inner border; equals `joint_inner_mm` where the weld is missing."""
    outer_mm: Array
    joint_inner_mm: Array
    joint_outer_mm: Array
    present: Cells
    """Where there is a bead."""

    @property
    def step_rad(self) -> float:
        """Angle between two neighbours."""
        return float(self.theta_rad[1] - self.theta_rad[0])

    def at(self, angle_rad: Array, values: Array) -> Array:
        """Return `values` (M,) interpolated at other angles, round the ring if the weld is one."""
        return np.asarray(np.interp(angle_rad, self.theta_rad, values, period=self.geometry.period_rad))

    def cells_inside(self, angle_rad: Array, radius_mm: Array, columns: int) -> Cells:
        """Return the cells (M, columns) of the bead's grid (angle, t from -1 to 1) inside a closed line.

        Cell (m, n) lies between the grid's lines m and m + 1, n and n + 1; the last column is not a cell.
        """
        center, inner, outer = (self.at(angle_rad, v) for v in (self.center_mm, self.inner_mm, self.outer_mm))
        is_outside = radius_mm > center
        t = np.where(
            is_outside, (radius_mm - center) / (outer - center), (radius_mm - center) / (center - inner)
        )
        rows = self.theta_rad.size
        row, column = (angle_rad - self.theta_rad[0]) / self.step_rad - 0.5, (t + 1) / 2 * (columns - 1) - 0.5
        cells = np.zeros((rows, columns), bool)
        for turn in (-rows, 0, rows) if self.geometry.is_closed else (0,):
            cells[polygon(row + turn, column, cells.shape)] = True  # type: ignore[no-untyped-call]
        return cells

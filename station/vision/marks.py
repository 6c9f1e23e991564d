"""Marks of weld and bare joint on a reduced picture: what the ring network gives, in two resolutions."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

CELL_PX = 4
"""Side of a cell in px of the reduced picture: 0.2 mm."""
AREA_PX = 2 * CELL_PX
"""Side of an area, of 2 x 2 cells, in px of the reduced picture: 0.4 mm."""
SPLIT = 2
"""Number of parts into which a cell is split along each side."""
PART_PX = CELL_PX / SPLIT
"""Side of a part of a cell in px of the reduced picture: 0.1 mm."""
JOINT_WEIGHT = 2.0
"""Weight of bare joint, which is about half as wide as the narrowest bead, in the marks of an area."""
CHANNELS = 2 * SPLIT * SPLIT
"""Number of values of a cell: bead, then bare joint, of its parts row by row."""

Field = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Window:
    """A part of the marks at full resolution."""

    coverage: Field
    """Covered fractions (rows, columns, 2) of bead and bare joint, 0 to 1."""
    column: int
    """Column of its first part in the whole picture."""
    row: int
    """Row of its first part in the whole picture."""


@dataclass(frozen=True, slots=True, eq=False)
class Marks:
    """Covered fractions of bead and bare joint on a picture."""

    values: Field
    """Fractions (8, rows, columns), 0 to 1: four parts of bead, then of bare joint, for each cell; rows and
    columns are even."""

    def areas(self) -> Field:
        """Return how much bead and bare joint, which weighs more, is in each area: 0 to 1.

        There are (rows / 2, columns / 2) areas.
        """
        parts = SPLIT * SPLIT
        bead, joint = self.values[:parts].mean(axis=0), self.values[parts:].mean(axis=0)
        joined = np.minimum(bead + np.float32(JOINT_WEIGHT) * joint, np.float32(1))
        rows, columns = joined.shape
        size = (columns * CELL_PX // AREA_PX, rows * CELL_PX // AREA_PX)
        return np.asarray(cv2.resize(joined, size, interpolation=cv2.INTER_AREA), np.float32)

    def around(self, x: float, y: float, reach: float) -> Window:
        """Return the parts within `reach` of (x, y), px of the reduced picture, as far as they exist."""
        _, rows, columns = self.values.shape
        left, right = _range(x, reach, columns)
        top, bottom = _range(y, reach, rows)
        cut = self.values[:, top:bottom, left:right]
        height, width = cut.shape[1:]
        split = cut.reshape(2, SPLIT, SPLIT, height, width).transpose(3, 1, 4, 2, 0)
        coverage = np.ascontiguousarray(split).reshape(height * SPLIT, width * SPLIT, 2)
        return Window(coverage, column=left * SPLIT, row=top * SPLIT)


def _range(middle: float, reach: float, count: int) -> tuple[int, int]:
    """Return the first of the `count` cells within reach of a place and the one after the last."""
    first = int(np.clip((middle - reach) // CELL_PX, 0, count - 1))
    return first, int(np.clip((middle + reach) // CELL_PX + 2, first + 1, count))

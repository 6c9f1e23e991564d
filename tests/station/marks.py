"""Marks of a perfect network: circles drawn without any picture."""

import numpy as np
from numpy.typing import NDArray

from station.domain import Image
from station.vision.locate import MarkFinder
from station.vision.marks import CELL_PX, PART_PX, SPLIT, Marks

Field = NDArray[np.float64]

BEAD_PX = 8.0
"""Half width of a drawn bead in px of the reduced picture: 0.42 mm."""
JOINT_PX = 2.2
"""Half width of a drawn joint."""


def parts_of(picture: Image) -> tuple[Field, Field]:
    """Places (x, y) of the parts of cells of a picture, in its px; a multiple of 16 px along each side."""
    rows, columns = (-(-side // (4 * CELL_PX)) * 4 * CELL_PX / PART_PX for side in picture.shape)
    y, x = np.mgrid[0:rows, 0:columns]
    return (x + 0.5) * PART_PX - 0.5, (y + 0.5) * PART_PX - 0.5


def arc(x: Field, y: Field, *, circle: tuple[float, float, float], half: float) -> Field:
    """Covered fractions of a ring of this half width around a circle (x, y, radius)."""
    away = np.abs(np.hypot(x - circle[0], y - circle[1]) - circle[2])
    return np.clip((half - away) / PART_PX + 0.5, 0, 1)


def marks_of(bead: Field, joint: Field) -> Marks:
    """Marks of covered fractions of all parts (rows, columns)."""
    rows, columns = bead.shape
    both = np.stack([bead, joint]).reshape(2, rows // SPLIT, SPLIT, columns // SPLIT, SPLIT)
    values = both.transpose(0, 2, 4, 1, 3).reshape(2 * SPLIT * SPLIT, rows // SPLIT, columns // SPLIT)
    return Marks(np.ascontiguousarray(values, np.float32))


def finder(*circles: tuple[float, float, float]) -> MarkFinder:
    """A network that sees a whole bead on each of the circles, in px of the reduced picture."""

    def find(picture: Image) -> Marks:
        x, y = parts_of(picture)
        beads = [arc(x, y, circle=circle, half=BEAD_PX) for circle in circles]
        return marks_of(np.max(beads, axis=0) if beads else 0 * x, 0 * x)

    return find

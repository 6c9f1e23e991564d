"""What a height field is made of: height, reflectance, roughness, and what is where."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from synth.heightfield.grid import Field


class Place(IntEnum):
    """What a pixel of a mask shows; the numbers are those of the mask's file."""

    OTHER = 0
    BEAD = 1
    BARE_JOINT = 2
    """The joint, where the bead is missing."""
    HOLE = 3
    """A hole in the bead."""


@dataclass(slots=True, eq=False)
class Surface:
    """A part that is being made, cell by cell; each (H, W).

    Arrays are changed in place by what is added to the part.
    """

    x_mm: Field
    y_mm: Field
    cell_mm: float
    height_mm: Field
    reflectance: Field
    """Reflectance relative to a clean metal, 0 to 1."""
    roughness: Field
    """GGX roughness."""
    place: NDArray[np.uint8]
    """`Place` of each cell."""

    def blend(
        self, weight: Field, *, reflectance: float | Field | None = None, roughness: float | None = None
    ) -> None:
        """Mix another reflectance or roughness in, by a weight (H, W), 0 to 1."""
        if reflectance is not None:
            self.reflectance += weight * (np.asarray(reflectance, np.float32) - self.reflectance)
        if roughness is not None:
            self.roughness += weight * (np.float32(roughness) - self.roughness)

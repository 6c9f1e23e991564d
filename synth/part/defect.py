"""What the generator needs to know of any defect, and of the ranges that it is drawn from.

Part coordinates: angles in rad along the weld, radii in mm across it (see `synth.part.geometry`). Each kind
of defect has one module in `synth.defects` that fills this in.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from synth.part.bead import Bead
from synth.part.borders import Borders, Cells
from synth.part.ranges import Weight

Array = NDArray[np.float64]
Line = tuple[Array, Array]
"""Closed line of points: angles (K,) in rad and radii (K,) in mm."""


class Defect(ABC):
    """One drawn defect."""

    __slots__ = ()

    kind: ClassVar[str]
    """Name of the kind, as in `station.defects`."""

    @abstractmethod
    def span_deg(self, bead: Bead) -> tuple[float, float]:
        """Return where the defect starts and ends along the weld; the end may exceed 360."""

    @abstractmethod
    def size_mm(self, bead: Bead) -> tuple[float, float]:
        """Return length and width, as labels state them."""

    @abstractmethod
    def outline(self, borders: Borders) -> Line:
        """Return the exact border of what is seen of the defect; no points if a straight piece lacks it."""

    def extent(self, bead: Bead) -> Line:
        """Return points whose box is the label's box: by default the corners of span and bead."""
        start, end = np.deg2rad(self.span_deg(bead))
        angle = np.linspace(start, end, 361)
        inner, outer = (
            np.full_like(angle, bead.radius_mm + side * bead.half_width_mm) for side in (-1.0, 1.0)
        )
        return np.concatenate([angle, angle]), np.concatenate([inner, outer])

    def cut(self, borders: Borders, columns: int) -> Cells | None:
        """Return the cells (M, columns) of the bead's grid that the defect removes, None if none."""
        return None

    def raise_mm(self, borders: Borders, columns: int) -> Array | None:
        """Return by how much the defect raises the bead (M, columns), None if it leaves the relief."""
        return None

    def shape(self, theta_rad: Array, bead: Bead) -> Array | None:
        """Return the factor of the bead's width at some angles, 0 without bead, None if it stays."""
        return None


@dataclass(frozen=True, slots=True)
class DefectRanges(ABC):
    """Ranges of one kind of defect in a generator recipe."""

    weight: Weight = 1.0
    """How many parts of a lot show this kind of defect, relative to `ok_weight` and the other kinds."""

    @abstractmethod
    def draw(self, rng: np.random.Generator, bead: Bead) -> tuple[Defect, ...]:
        """Draw the defects of a part of this kind in a lot."""

    @abstractmethod
    def draw_on_piece(self, rng: np.random.Generator, bead: Bead) -> tuple[Defect, ...]:
        """Draw the defects of a straight piece, so that its crop shows this kind."""

    @abstractmethod
    def draw_on_ring(self, rng: np.random.Generator, bead: Bead, fraction: float) -> tuple[Defect, ...]:
        """Draw the defects of a dataset's ring, so that about `fraction` of its crops show this kind."""

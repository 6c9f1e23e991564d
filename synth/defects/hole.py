"""Holes in the bead (paper, section 3.5.1, eq. 3), with melt that sinks or is heaped up round them."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENTS
from synth.part.bead import Bead
from synth.part.borders import Borders, Cells
from synth.part.defect import Defect, DefectRanges, Line
from synth.part.ranges import NO_OTHER_KEYS, Few, Range, count, log_uniform, uniform, within

Array = NDArray[np.float64]

POINTS = 180
"""Points of an outline."""
PIECE_DEG = 6.5
"""Largest angle between the middle of a straight piece and the middle of its holes."""


@dataclass(frozen=True, slots=True)
class Rim:
    """How the melt lies round the holes of one part; see `HoleRanges`."""

    sink_mm: float
    width_mm: float
    crest_mm: float


@dataclass(frozen=True, slots=True)
class Hole(Defect):
    """A hole in the bead: a deformed ellipse (paper, eq. 3)."""

    kind = "hole"

    angle_deg: float
    offset_mm: float
    """Distance of the hole's middle from the bead's centre line, outwards positive."""
    length_mm: float
    """Length along the weld."""
    width_mm: float
    """Width across the weld."""
    deformation: float
    """Factor d of eq. (3), 0 to 1: 0 is an ellipse."""
    a: int
    b: int
    """Frequencies a and b of eq. (3)."""
    rim: Rim

    def span_deg(self, bead: Bead) -> tuple[float, float]:
        """Return where the hole starts and ends along the weld."""
        half_deg = float(np.rad2deg(self.length_mm / bead.radius_mm / 2))
        return self.angle_deg - half_deg, self.angle_deg + half_deg

    def size_mm(self, bead: Bead) -> tuple[float, float]:
        """Return length and width."""
        return self.length_mm, self.width_mm

    def extent(self, bead: Bead) -> Line:
        """Return the border of the hole."""
        return self._ellipse(bead.radius_mm)

    def outline(self, borders: Borders) -> Line:
        """Return the border of the hole."""
        return self._ellipse(borders.geometry.radius_mm)

    def cut(self, borders: Borders, columns: int) -> Cells:
        """Return the cells that the hole removes from the bead's grid."""
        return borders.cells_inside(*self.outline(borders), columns)

    def raise_mm(self, borders: Borders, columns: int) -> Array | None:
        """Return how the melt sinks towards the hole's edge, or is heaped up to a lip round it."""
        hole = self.cut(borders, columns)
        if not hole.any():
            return None
        wrapped = np.concatenate(
            [hole[-64:], hole, hole[:64]]
        )  # of a straight piece, too: no hole reaches its far end
        cells = cv2.distanceTransform((~wrapped).astype(np.uint8), cv2.DIST_L2, 3)[64:-64]
        away_mm = (
            cells.astype(np.float64) * borders.step_rad * borders.geometry.radius_mm
        )  # cells are nearly square
        return np.asarray(
            -self.rim.sink_mm * np.exp(-(((away_mm - self.rim.crest_mm) / self.rim.width_mm) ** 2))
        )

    def _ellipse(self, radius_mm: float) -> Line:
        """Return the deformed ellipse of eq. (3), scaled so that its box is `length_mm` by `width_mm`."""
        x = np.linspace(0, 2 * np.pi, POINTS, endpoint=False)
        d = self.deformation * 0.35
        along = self.a * np.cos(x) + d * np.sin(self.a * x)
        across = self.b * np.sin(x) + d * np.cos(self.b * x)
        along = (along - (along.max() + along.min()) / 2) / np.ptp(along) * self.length_mm
        across = (across - (across.max() + across.min()) / 2) / np.ptp(across) * self.width_mm
        return np.deg2rad(self.angle_deg) + along / radius_mm, radius_mm + self.offset_mm + across


@dataclass(frozen=True, slots=True)
class HoleRanges(DefectRanges):
    """Ranges of holes."""

    __pydantic_config__ = NO_OTHER_KEYS

    count: Few = (1, 3)
    """Number of holes of a part with holes, both ends included."""
    length_mm: Annotated[Range, within(0.04, 6)] = (0.09, 2.4)
    """Length of a hole along the weld, drawn log-uniformly."""
    rim_mm: Annotated[Range, within(-0.1, 0.2)] = (0.01, 0.05)
    """How far the melt sinks towards a hole's edge; below 0 it is heaped up to a lip."""
    rim_width_mm: Annotated[Range, within(0.01, 0.3)] = (0.02, 0.06)
    """How far from the edge the melt still sinks."""
    crest_mm: Annotated[Range, within(0.0, 0.2)] = (0.0, 0.02)
    """Distance from the edge at which it sinks most."""

    def draw(self, rng: np.random.Generator, bead: Bead) -> tuple[Hole, ...]:
        """Draw the holes of a part, anywhere round the ring."""
        rim = self._rim(rng)
        return tuple(self._hole(rng, bead, rim) for _ in range(count(rng, self.count)))

    def draw_on_piece(self, rng: np.random.Generator, bead: Bead) -> tuple[Hole, ...]:
        """Draw the one or two holes of a straight piece."""
        rim = self._rim(rng)
        angles = rng.uniform(-PIECE_DEG, PIECE_DEG, int(rng.integers(1, 3)))
        return tuple(replace(self._hole(rng, bead, rim), angle_deg=float(angle)) for angle in angles)

    def draw_on_ring(self, rng: np.random.Generator, bead: Bead, fraction: float) -> tuple[Hole, ...]:
        """Draw the holes of a ring of a dataset: about as many as its crops should show."""
        rim = self._rim(rng)
        return tuple(
            self._hole(rng, bead, rim) for _ in range(rng.binomial(SEGMENTS, min(0.9, 1.15 * fraction)))
        )

    def _rim(self, rng: np.random.Generator) -> Rim:
        return Rim(uniform(rng, self.rim_mm), uniform(rng, self.rim_width_mm), uniform(rng, self.crest_mm))

    def _hole(self, rng: np.random.Generator, bead: Bead, rim: Rim) -> Hole:
        """Draw one hole, small to long."""
        length_mm = log_uniform(rng, self.length_mm)
        width_mm = min(length_mm * uniform(rng, (0.8, 1.2)), uniform(rng, (0.2, 1.1)) * bead.half_width_mm)
        room_mm = max(0.0, 0.75 * bead.half_width_mm - width_mm / 2)
        return Hole(
            angle_deg=uniform(rng, (0.0, 360.0)),
            offset_mm=uniform(rng, (-1.0, 1.0)) * room_mm,
            length_mm=length_mm,
            width_mm=width_mm,
            deformation=uniform(rng, (0.0, 1.0)),
            a=int(rng.integers(3, 6)),
            b=int(rng.integers(2, 4)),
            rim=rim,
        )


_DENSE = HoleRanges(weight=0.45, count=(4, 9), length_mm=(0.08, 2.4))

RANGES: Mapping[str, HoleRanges] = {
    "line": HoleRanges(weight=0.3),
    "dense": _DENSE,
    "wide": replace(_DENSE, rim_mm=(-0.04, 0.06), rim_width_mm=(0.015, 0.09), crest_mm=(0.0, 0.05)),
    "paper": HoleRanges(weight=0.25),
}
"""Ranges of each named generator recipe."""

"""Arcs without weld, where the bare joint shows (paper, section 3.5.2)."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from synth.part.bead import Bead
from synth.part.borders import Borders
from synth.part.defect import Defect, DefectRanges, Line
from synth.part.ranges import NO_OTHER_KEYS, Fraction, Range, uniform, within

Array = NDArray[np.float64]

SECOND_ARC = 0.3
"""Fraction of the parts with a missing weld that lack it on two arcs."""


@dataclass(frozen=True, slots=True)
class MissingWeld(Defect):
    """An arc without weld. `end_deg` may exceed 360."""

    kind = "missing_weld"

    start_deg: float
    end_deg: float

    def span_deg(self, bead: Bead) -> tuple[float, float]:
        """Return where the arc starts and ends."""
        return self.start_deg, self.end_deg

    def size_mm(self, bead: Bead) -> tuple[float, float]:
        """Return the length of the arc and the width that the bead should have."""
        return float(np.deg2rad(self.end_deg - self.start_deg) * bead.radius_mm), 2 * bead.half_width_mm

    def outline(self, borders: Borders) -> Line:
        """Return the border of the bare joint along the arc."""
        first, last = borders.geometry.clipped(
            float(np.deg2rad(self.start_deg)), float(np.deg2rad(self.end_deg))
        )
        if last <= first:
            return np.empty(0), np.empty(0)
        angle = np.linspace(first, last, max(8, int((last - first) / borders.step_rad)))
        outer, inner = borders.at(angle, borders.joint_outer_mm), borders.at(angle, borders.joint_inner_mm)
        return np.concatenate([angle, angle[::-1]]), np.concatenate([outer, inner[::-1]])

    def shape(self, theta_rad: Array, bead: Bead) -> Array:
        """Return the factor of the bead's width: 0 on the arc, with rounded ends of the bead next to it."""
        if self.end_deg - self.start_deg >= 360:
            return np.zeros_like(theta_rad)
        middle = np.deg2rad((self.start_deg + self.end_deg) / 2)
        half = np.deg2rad((self.end_deg - self.start_deg) / 2)
        away_rad = np.abs((theta_rad - middle + np.pi) % (2 * np.pi) - np.pi) - half
        end = np.clip(away_rad * bead.radius_mm / (0.7 * bead.half_width_mm), 0.0, 1.0)
        return np.asarray(np.sqrt(1.0 - (1.0 - end) ** 2))


@dataclass(frozen=True, slots=True)
class MissingWeldRanges(DefectRanges):
    """Ranges of missing welds."""

    __pydantic_config__ = NO_OTHER_KEYS

    arc_deg: Annotated[Range, within(1, 359)] = (12.0, 110.0)
    """Length of the arc."""
    all_round_fraction: Fraction = 0.12
    """Fraction of the parts with a missing weld that have no weld at all."""

    def draw(self, rng: np.random.Generator, bead: Bead) -> tuple[MissingWeld, ...]:
        """Draw one or two arcs of a part, or the whole ring."""
        if rng.random() < self.all_round_fraction:
            return (MissingWeld(0.0, 360.0),)
        start_deg = uniform(rng, (0.0, 360.0))
        first = MissingWeld(start_deg, start_deg + uniform(rng, self.arc_deg))
        if rng.random() >= SECOND_ARC:
            return (first,)
        second_deg = first.end_deg + uniform(rng, (40.0, 120.0))
        return (first, MissingWeld(second_deg, second_deg + uniform(rng, (self.arc_deg[0], 60.0))))

    def draw_on_piece(self, rng: np.random.Generator, bead: Bead) -> tuple[MissingWeld, ...]:
        """Draw a straight piece without weld, or with the end of a bead in view."""
        edge_deg = uniform(rng, (-3.0, 8.0)) if rng.random() < 0.35 else 90.0
        return (MissingWeld(-90.0, edge_deg) if rng.random() < 0.5 else MissingWeld(-edge_deg, 90.0),)

    def draw_on_ring(self, rng: np.random.Generator, bead: Bead, fraction: float) -> tuple[MissingWeld, ...]:
        """Draw one or two arcs of a ring of a dataset, about `fraction` of it, or the whole ring."""
        if fraction <= 0:
            return ()
        if rng.random() < self.all_round_fraction * fraction:
            return (MissingWeld(0.0, 360.0),)
        arc_deg = min(330.0, max(24.0, 360.0 * fraction * uniform(rng, (0.6, 1.6))))
        start_deg = uniform(rng, (0.0, 360.0))
        if arc_deg <= 60 or rng.random() >= 0.5:
            return (MissingWeld(start_deg, start_deg + arc_deg),)
        starts = (start_deg, start_deg + 180)
        return tuple(MissingWeld(start, start + arc_deg / 2) for start in starts)


_DENSE = MissingWeldRanges(weight=0.3, arc_deg=(10.0, 150.0))

RANGES: Mapping[str, MissingWeldRanges] = {
    "line": MissingWeldRanges(weight=0.3),
    "dense": _DENSE,
    "wide": _DENSE,
    "paper": MissingWeldRanges(weight=0.25),
}
"""Ranges of each named generator recipe."""

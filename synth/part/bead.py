"""The bead: its course, cross-section and ends."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Range, uniform, within


@dataclass(frozen=True, slots=True)
class Bead:
    """One drawn bead; see `BeadRanges` for the other fields."""

    radius_mm: float
    half_width_mm: float
    offset_mm: float
    crown_mm: float
    wobble_mm: float
    undercut_mm: float
    overlap_mm: float
    overlap_width: float
    overlap_height_mm: float
    crater_mm: float
    start_deg: float
    """Where the weld starts and, after the overlap, ends."""
    direction: int
    """+1: welded clockwise as seen in the image, -1: the other way."""


@dataclass(frozen=True, slots=True)
class BeadRanges:
    """Ranges of the bead's course, cross-section and ends."""

    __pydantic_config__ = NO_OTHER_KEYS

    radius_mm: Annotated[Range, within(4.0, 7.0)] = (5.50, 5.63)
    """Radius of the weld's centre line."""
    half_width_mm: Annotated[Range, within(0.2, 0.7)] = (0.39, 0.54)
    """Half the width of the bead."""
    offset_mm: Annotated[Range, within(-0.3, 0.3)] = (-0.04, 0.04)
    """How far the bead's centre line runs outside the joint's."""
    crown_mm: Annotated[Range, within(0, 0.2)] = (0.015, 0.06)
    """Height of the bead's crown above the partners."""
    wobble_mm: Annotated[Range, within(0, 0.2)] = (0.0, 0.025)
    """Amplitude of the random border contour."""
    undercut_mm: Annotated[Range, within(0, 0.2)] = (0.0, 0.01)
    """Depth of the groove along the bead's borders."""
    overlap_mm: Annotated[Range, within(0, 10)] = (0.5, 3.0)
    """How far the weld's end runs over its start."""
    overlap_width: Annotated[Range, within(-0.3, 0.5)] = (0.0, 0.08)
    """How much wider the bead is there, relative to its width."""
    overlap_height_mm: Annotated[Range, within(0, 0.2)] = (0.0, 0.02)
    """How much higher the bead is there."""
    crater_mm: Annotated[Range, within(0, 0.3)] = (0.005, 0.05)
    """Depth of the crater at the weld's end."""

    def draw(self, rng: np.random.Generator) -> Bead:
        """Draw a bead."""
        return Bead(
            radius_mm=uniform(rng, self.radius_mm),
            half_width_mm=uniform(rng, self.half_width_mm),
            offset_mm=uniform(rng, self.offset_mm),
            crown_mm=uniform(rng, self.crown_mm),
            wobble_mm=uniform(rng, self.wobble_mm),
            undercut_mm=uniform(rng, self.undercut_mm),
            overlap_mm=uniform(rng, self.overlap_mm),
            overlap_width=uniform(rng, self.overlap_width),
            overlap_height_mm=uniform(rng, self.overlap_height_mm),
            crater_mm=uniform(rng, self.crater_mm),
            start_deg=uniform(rng, (0.0, 360.0)),
            direction=1 if rng.random() < 0.5 else -1,
        )

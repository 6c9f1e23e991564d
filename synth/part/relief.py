"""The bead's relief: ripples and discontinuities."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Fraction, Fractions, Range, uniform, within


@dataclass(frozen=True, slots=True)
class Relief:
    """One drawn relief; see `ReliefRanges` for the other fields."""

    is_spectral: bool
    """True if the relief comes from the measurement's spectrum, eq. (2); else ripples are drawn directly."""
    height_scale: float
    shift_scale: float
    ripple_pitch_mm: float
    ripple_slope: float
    crescent_mm: float
    sparsity: float
    chevron: float
    rough_slope: float


@dataclass(frozen=True, slots=True)
class ReliefRanges:
    """Ranges of the bead's relief."""

    __pydantic_config__ = NO_OTHER_KEYS

    spectral_fraction: Fraction = 0.3
    """Fraction of parts with a relief from the measured spectrum (paper, eq. 2), not with drawn ripples."""
    height_scale: Annotated[Range, within(0, 10)] = (0.7, 2.0)
    """Factor of the height of the spectral relief."""
    shift_scale: Annotated[Range, within(0, 5)] = (0.5, 2.0)
    """Factor of the row shift that was fitted to the measurement (paper, Fig. 4b)."""
    ripple_pitch_mm: Annotated[Range, within(0.04, 1)] = (0.10, 0.30)
    """Distance between two solidification ripples along the weld."""
    ripple_slope: Annotated[Range, within(0, 1)] = (0.06, 0.36)
    """Steepness of the ripples: root mean square of dz/ds."""
    crescent_mm: Annotated[Range, within(0, 2)] = (0.15, 0.60)
    """How far the ripple's middle runs ahead of its ends."""
    sparsity: Fractions = (0.0, 0.4)
    """How far the ripples are gathered into few deep ones with calm weld between."""
    chevron: Fractions = (0.0, 0.4)
    """Form of the ripples, from a round crescent (0) to a sharp arrow (1)."""
    rough_slope: Annotated[Range, within(0, 1)] = (0.02, 0.11)
    """Steepness of the Perlin noise that models the weld's discontinuities."""

    def draw(self, rng: np.random.Generator) -> Relief:
        """Draw a relief."""
        return Relief(
            is_spectral=bool(rng.random() < self.spectral_fraction),
            height_scale=uniform(rng, self.height_scale),
            shift_scale=uniform(rng, self.shift_scale),
            ripple_pitch_mm=uniform(rng, self.ripple_pitch_mm),
            ripple_slope=uniform(rng, self.ripple_slope),
            crescent_mm=uniform(rng, self.crescent_mm),
            sparsity=uniform(rng, self.sparsity),
            chevron=uniform(rng, self.chevron),
            rough_slope=uniform(rng, self.rough_slope),
        )

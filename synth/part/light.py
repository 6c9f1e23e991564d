"""The ring light above the part, as far as it varies."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Fraction, Fractions, Range, uniform, within


@dataclass(frozen=True, slots=True)
class Light:
    """One drawn light; see `LightRanges` for the other fields."""

    scale: float
    lean: float
    heading_deg: float
    """Side on which the light is brighter, an angle as in the image."""
    second: float
    """Strength of the second light, 0 without one."""


@dataclass(frozen=True, slots=True)
class LightRanges:
    """Ranges of the light."""

    __pydantic_config__ = NO_OTHER_KEYS

    scale: Annotated[Range, within(0.3, 2)] = (1.0, 1.0)
    """Size of the light's rings, relative to the nominal ones."""
    lean: Fractions = (0.0, 0.1)
    """How much brighter the light is on one side."""
    second_fraction: Fraction = 0.0
    """Fraction of parts that a second, low ring light illuminates as well."""
    second: Annotated[Range, within(0, 10)] = (0.3, 2.0)
    """Strength of the second light, relative to the first."""

    def draw(self, rng: np.random.Generator) -> Light:
        """Draw a light."""
        scale, lean, heading_deg = (
            uniform(rng, self.scale),
            uniform(rng, self.lean),
            uniform(rng, (0.0, 360.0)),
        )
        has_second, second = rng.random() < self.second_fraction, uniform(rng, self.second)
        return Light(scale=scale, lean=lean, heading_deg=heading_deg, second=second if has_second else 0.0)

"""Metal and finish of bead, partners and the floor below the joint."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Fractions, Range, uniform, within

Material = Literal["steel", "aluminium", "copper", "nickel-plated"]


@dataclass(frozen=True, slots=True)
class Surface:
    """One drawn finish; see `SurfaceRanges`."""

    material: Material
    bead_reflectance: float
    partner_reflectance: float
    alpha_weld: float
    alpha_partner: float
    floor_reflectance: float
    floor_texture: float
    has_circles: bool


@dataclass(frozen=True, slots=True)
class SurfaceRanges:
    """Ranges of metal and finish."""

    __pydantic_config__ = NO_OTHER_KEYS

    material: Material = "aluminium"
    """Metal of bead and partners."""
    bead_reflectance: Fractions = (0.80, 0.92)
    """Reflectance of the bead, relative to a clean surface of its metal."""
    partner_reflectance: Fractions = (0.65, 0.80)
    """Reflectance of the partners, relative to a clean surface of their metal."""
    alpha_weld: Annotated[Range, within(0.01, 1)] = (0.18, 0.18)
    """Roughness of the weld (paper, section 4.1)."""
    alpha_partner: Annotated[Range, within(0.01, 1)] = (0.20, 0.20)
    """Roughness of the partners (paper, section 4.1)."""
    floor_reflectance: Fractions = (0.03, 0.03)
    """Reflectance of what lies below holes and joint."""
    floor_texture: Fractions = (0.0, 0.5)
    """How uneven that reflectance is."""
    circles: bool = True
    """Bores, grooves and steps on the part that are not welds."""

    def draw(self, rng: np.random.Generator) -> Surface:
        """Draw a finish."""
        return Surface(
            material=self.material,
            bead_reflectance=uniform(rng, self.bead_reflectance),
            partner_reflectance=uniform(rng, self.partner_reflectance),
            alpha_weld=uniform(rng, self.alpha_weld),
            alpha_partner=uniform(rng, self.alpha_partner),
            floor_reflectance=uniform(rng, self.floor_reflectance),
            floor_texture=uniform(rng, self.floor_texture),
            has_circles=self.circles,
        )

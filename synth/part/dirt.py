"""What lies on the part besides the weld: soot, droplets, scratches, dust, fibres and tint."""

from dataclasses import dataclass

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Few, Fractions, count, uniform


@dataclass(frozen=True, slots=True)
class Dirt:
    """Drawn dirt of one part; see `DirtRanges`."""

    soot: float
    soot_softness: float
    heat_tint: float
    spatter: int
    bead_scratches: int
    scratches: int
    dust: int
    fibres: int


@dataclass(frozen=True, slots=True)
class DirtRanges:
    """Ranges of dirt; counts include both ends and are those of a whole part."""

    __pydantic_config__ = NO_OTHER_KEYS

    soot: Fractions = (0.0, 0.6)
    """Amount of soot, on the weld and at its edges."""
    soot_softness: Fractions = (0.0, 0.6)
    """Form of the soot, from patches with sharp edges (0) to clouds (1)."""
    heat_tint: Fractions = (0.0, 0.35)
    """How much the partners are tinted next to the weld."""
    spatter: Few = (0, 4)
    """Droplets of melt on bead and partners."""
    bead_scratches: Few = (0, 2)
    """Scratches on the bead."""
    scratches: Few = (0, 13)
    """Scratches on the partners."""
    dust: Few = (0, 40)
    """Specks on the partners."""
    fibres: Few = (0, 1)
    """Thin fibres lying across the part."""

    def draw(self, rng: np.random.Generator) -> Dirt:
        """Draw the dirt of a part."""
        return Dirt(
            soot=uniform(rng, self.soot),
            soot_softness=uniform(rng, self.soot_softness),
            heat_tint=uniform(rng, self.heat_tint),
            spatter=count(rng, self.spatter),
            bead_scratches=count(rng, self.bead_scratches),
            scratches=count(rng, self.scratches),
            dust=count(rng, self.dust),
            fibres=count(rng, self.fibres),
        )

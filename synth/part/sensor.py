"""Lens and sensor, as far as they vary."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Fractions, Range, log_uniform, uniform, within


@dataclass(frozen=True, slots=True)
class Sensor:
    """Drawn lens and sensor; see `SensorRanges`."""

    veil: float
    exposure: float
    defocus_px: float
    read_noise_dn: float


@dataclass(frozen=True, slots=True)
class SensorRanges:
    """Ranges of lens and sensor."""

    __pydantic_config__ = NO_OTHER_KEYS

    veil: Fractions = (0.0, 0.02)
    """Veiling glare: fraction of the mean radiance that lies over the whole image."""
    exposure: Annotated[Range, within(0.05, 20)] = (0.6, 1.5)
    """Exposure, relative to the nominal one; drawn log-uniformly."""
    defocus_px: Annotated[Range, within(0.1, 5)] = (0.3, 1.3)
    """Standard deviation of the Gaussian blur of the lens."""
    read_noise_dn: Annotated[Range, within(0, 20)] = (0.4, 1.5)
    """Read noise in grey levels."""

    def draw(self, rng: np.random.Generator) -> Sensor:
        """Draw a lens and a sensor."""
        return Sensor(
            veil=uniform(rng, self.veil),
            exposure=log_uniform(rng, self.exposure),
            defocus_px=uniform(rng, self.defocus_px),
            read_noise_dn=uniform(rng, self.read_noise_dn),
        )

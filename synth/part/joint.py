"""The joint between the two partners that the weld closes."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np

from synth.part.ranges import NO_OTHER_KEYS, Range, either_way, uniform, within


@dataclass(frozen=True, slots=True)
class Joint:
    """One drawn joint; see `JointRanges`."""

    step_mm: float
    """Height of the inner partner above the outer one."""
    gap_mm: float
    wave_mm: float


@dataclass(frozen=True, slots=True)
class JointRanges:
    """Ranges of the joint."""

    __pydantic_config__ = NO_OTHER_KEYS

    step_mm: Annotated[float, within(0, 0.3)] = 0.03
    """Largest height difference between inner and outer partner, either way."""
    gap_mm: Annotated[Range, within(0.01, 0.5)] = (0.05, 0.16)
    """Width of the joint where the weld is missing."""
    wave_mm: Annotated[Range, within(0, 0.2)] = (0.004, 0.02)
    """Standard deviation of the joint's line (paper, eq. 4)."""

    def draw(self, rng: np.random.Generator) -> Joint:
        """Draw a joint."""
        return Joint(
            step_mm=either_way(rng, self.step_mm),
            gap_mm=uniform(rng, self.gap_mm),
            wave_mm=uniform(rng, self.wave_mm),
        )

"""Where the part lies below the camera. numpy only, mm."""

from dataclasses import dataclass, replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from synth.part.ranges import NO_OTHER_KEYS, either_way, within

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Pose:
    """Place and tilt of one part."""

    center_mm: tuple[float, float]
    """(x, y) of the ring's centre in the object plane, from the optical axis, y down."""
    tilt_deg: tuple[float, float]
    """Rotation about the x and the y axis."""

    def centered(self) -> "Pose":
        """Return the same tilt in the middle of the image."""
        return replace(self, center_mm=(0.0, 0.0))

    def matrix(self) -> Array:
        """Return the 4 x 4 matrix from part coordinates (y down) to world coordinates (y up)."""
        ax, ay = np.deg2rad(self.tilt_deg)
        rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
        ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
        matrix = np.eye(4)
        matrix[:3, :3] = ry @ rx @ np.diag([1.0, -1.0, 1.0])
        matrix[:2, 3] = self.center_mm[0], -self.center_mm[1]
        return matrix

    def to_world(self, points_mm: Array) -> Array:
        """Return part coordinates (..., 3) as world coordinates (..., 3), mm."""
        matrix = self.matrix()
        return np.asarray(points_mm @ matrix[:3, :3].T + matrix[:3, 3])


@dataclass(frozen=True, slots=True)
class PoseRanges:
    """Ranges of place and tilt."""

    __pydantic_config__ = NO_OTHER_KEYS

    shift_mm: Annotated[float, within(0, 5)] = 3.0
    """Largest off-centre shift of the part, along x and along y."""
    tilt_deg: Annotated[float, within(0, 5)] = 0.6
    """Largest tilt of the part about x and about y."""

    def draw(self, rng: np.random.Generator) -> Pose:
        """Draw a pose."""
        return Pose(
            center_mm=(either_way(rng, self.shift_mm), either_way(rng, self.shift_mm)),
            tilt_deg=(either_way(rng, self.tilt_deg), either_way(rng, self.tilt_deg)),
        )

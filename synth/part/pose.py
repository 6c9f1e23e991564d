"""Where a part's points lie in the world. numpy only, mm."""

import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part

Array = NDArray[np.float64]


def pose(part: Part) -> Array:
    """4 x 4 matrix from part coordinates (y down) to world coordinates (y up)."""
    ax, ay = np.deg2rad(part.tilt_deg)
    rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
    ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
    matrix = np.eye(4)
    matrix[:3, :3] = ry @ rx @ np.diag([1.0, -1.0, 1.0])
    matrix[:2, 3] = part.center_mm[0], -part.center_mm[1]
    return matrix


def to_world(part: Part, points_mm: Array) -> Array:
    """Part coordinates (..., 3) to world coordinates (..., 3), mm."""
    matrix = pose(part)
    return np.asarray(points_mm @ matrix[:3, :3].T + matrix[:3, 3])

"""Votes for circles: how much weld lies on a circle around each area, less what lies on both sides of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

from station.vision.marks import AREA_PX
from station.vision.reduced import FINDER_UM_PER_PX, Circle

Field = NDArray[np.float32]

AREA_MM = AREA_PX * FINDER_UM_PER_PX / 1000.0
"""Side of an area in mm."""
RIDGE_MM = 0.25
"""Half width of the ridge of the kernel, narrower than the narrowest bead."""
FLANK_MM = 1.1
"""Distance of the flanks from the circle, outside the widest bead."""
STEP_MM = 0.25
"""Step between the radii that are tried: each of them sees a bead whose radius is half a step away."""


@dataclass(frozen=True, slots=True)
class Vote:
    """The best circle."""

    circle: Circle
    """Its centre and radius in px of the reduced picture."""
    score: float
    """Covered fraction on the circle, less that on its flanks: 1 for a whole bead with nothing around it."""


def best_circle(areas: Field, radii_mm: Sequence[float]) -> Vote:
    """Return the best circle of one of these radii around one of the areas (rows, columns)."""
    best = Vote(Circle(0.0, 0.0, 0.0), -np.inf)
    for radius_mm in radii_mm:
        kernel = _kernel(radius_mm)
        score = np.asarray(cv2.filter2D(areas, -1, kernel, borderType=cv2.BORDER_CONSTANT), np.float32)
        _, highest, _, (column, row) = cv2.minMaxLoc(score)
        if highest > best.score:
            x, y = _peak(score, column, row)
            radius = radius_mm * 1000.0 / FINDER_UM_PER_PX
            best = Vote(Circle(_place_px(x), _place_px(y), radius), float(highest))
    return best


def radii_within(radius_mm: float, tolerance_mm: float) -> list[float]:
    """Return radii that leave none within the tolerance farther than half a step away."""
    count = 1 + 2 * int(np.ceil(max(0.0, tolerance_mm - STEP_MM / 2) / STEP_MM))
    return [float(value) for value in radius_mm + STEP_MM * (np.arange(count) - (count - 1) / 2)]


@lru_cache(maxsize=128)
def _kernel(radius_mm: float) -> Field:
    """Return a ridge of sum 1 along a circle, and a flank of sum -0.5 on each side."""
    half = int(np.ceil((radius_mm + FLANK_MM + RIDGE_MM) / AREA_MM))
    y, x = np.mgrid[-half : half + 1, -half : half + 1] * AREA_MM
    away = np.hypot(x, y) - radius_mm
    soft = AREA_MM / 2
    ridge = np.clip((RIDGE_MM + soft - np.abs(away)) / AREA_MM, 0, 1)
    flanks = [
        np.clip((RIDGE_MM + soft - np.abs(away - side)) / AREA_MM, 0, 1) for side in (-FLANK_MM, FLANK_MM)
    ]
    return np.asarray(ridge / ridge.sum() - sum(0.5 * flank / flank.sum() for flank in flanks), np.float32)


def _peak(score: Field, column: int, row: int) -> tuple[float, float]:
    """Return the top (x, y) of the parabolas through the highest area and its neighbours."""
    return (
        column + _top(score[row, max(0, column - 1) : column + 2]),
        row + _top(score[max(0, row - 1) : row + 2, column]),
    )


def _top(values: Field) -> float:
    if len(values) < 3:
        return 0.0
    before, here, after = map(float, values)
    bend = before - 2 * here + after
    return 0.0 if bend >= 0 else float(np.clip(0.5 * (before - after) / bend, -0.5, 0.5))


def _place_px(area: float) -> float:
    return (area + 0.5) * AREA_PX - 0.5

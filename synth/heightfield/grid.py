"""The picture plane of a height field, and random fields that are sampled on it. mm, float32."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.surface.noise import gaussian

Field = NDArray[np.float32]
"""Values on the picture plane, (H, W) float32, or of points of it."""

MAX_CELLS = 1024
"""Largest side of the tile that a random field repeats."""
CELLS_PER_GRAIN = 3.0
"""Samples of a random field along one grain."""


@dataclass(frozen=True, slots=True)
class Grid:
    """A square picture plane of `side` cells, `cell_mm` apart; its middle is the origin.

    x runs right, y down, z towards the camera.
    """

    side: int
    cell_mm: float

    def coordinates(self) -> tuple[Field, Field]:
        """Return x and y in mm of the cells' centres, each (side, side)."""
        line = ((np.arange(self.side) - (self.side - 1) / 2) * self.cell_mm).astype(np.float32)
        x, y = np.meshgrid(line, line)
        return x, y


def noise(rng: np.random.Generator, u_mm: Field, v_mm: Field, grain_mm: tuple[float, float]) -> Field:
    """Return smooth noise of standard deviation 1 at points (u, v), of a grain in mm along u and along v."""
    shape, step = [], []
    for grain, points in zip(grain_mm, (u_mm, v_mm), strict=True):
        span = float(np.ptp(points)) + grain
        cells = int(np.clip(np.ceil(span / grain * CELLS_PER_GRAIN), 8, MAX_CELLS))
        shape.append(cells)
        step.append(grain / CELLS_PER_GRAIN)
    tile = gaussian(rng, (shape[1], shape[0]), (CELLS_PER_GRAIN, CELLS_PER_GRAIN)).astype(np.float32)
    offset = rng.uniform(0, 1000, 2)
    at_u = np.mod(u_mm / np.float32(step[0]) + np.float32(offset[0]), np.float32(shape[0]))
    at_v = np.mod(v_mm / np.float32(step[1]) + np.float32(offset[1]), np.float32(shape[1]))
    return _sampled(tile, at_u.astype(np.float32), at_v.astype(np.float32))


def _sampled(tile: Field, at_u: Field, at_v: Field) -> Field:
    """Return a tile's values at (column, row) of any shape; OpenCV takes images of limited size only."""
    wide = 4096
    count = at_u.size
    rows = -(-count // wide)
    columns, lines = (np.resize(np.ravel(at), rows * wide).reshape(rows, wide) for at in (at_u, at_v))
    values = cv2.remap(tile, columns, lines, cv2.INTER_CUBIC, borderMode=cv2.BORDER_WRAP)
    return np.asarray(values.ravel()[:count].reshape(at_u.shape))


def turned(x_mm: Field, y_mm: Field, angle_rad: float) -> tuple[Field, Field]:
    """Return the points in axes that are turned by an angle: along it, and across it."""
    cosine, sine = np.float32(np.cos(angle_rad)), np.float32(np.sin(angle_rad))
    return cosine * x_mm + sine * y_mm, cosine * y_mm - sine * x_mm


def with_slope(height: Field, cell_mm: float, slope: float) -> Field:
    """Scale a height field so that its steeper direction has this root mean square slope."""
    steepness = max(float(np.diff(height, axis=axis).std()) for axis in (0, 1)) / cell_mm
    return np.asarray(height * np.float32(slope / max(steepness, 1e-9)))


def smooth_step(values: Field, low: float, high: float) -> Field:
    """Return 0 below `low`, 1 above `high`, and a smooth rise between."""
    part = np.clip((values - low) / (high - low), 0.0, 1.0)
    return np.asarray(part * part * (3 - 2 * part), np.float32)

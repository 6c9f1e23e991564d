"""Fits a circle between the borders read in its sectors; borders that do not belong to it hardly count."""

from dataclasses import dataclass

import numpy as np

from station.vision.polar import SECTOR_RAD, SECTORS, Array, Sectors
from station.vision.reduced import Circle

ROUNDS = 8
"""Number of times that the weights are set from the residuals."""
SMALLEST_PX = 0.15
"""Residual in px of the reduced picture below which a border counts fully."""
RADIUS = 2
"""Place of the radius among what is fitted: x, y, radius, half width."""
ALIKE = 15.0
"""Number of sectors whose errors are alike, as soot lies over many of them: so many count as one."""


@dataclass(frozen=True, slots=True)
class Prior:
    """What is known of the radius beforehand, in px of the reduced picture."""

    radius_px: float
    deviation_px: float
    """Its standard deviation."""


_AROUND = np.stack([np.cos(SECTOR_RAD), np.sin(SECTOR_RAD), np.ones(SECTORS)], axis=1)


def fit_circle(circle: Circle, sectors: Sectors, prior: Prior) -> tuple[Circle, Array]:
    """Return the circle halfway between the borders read around `circle`, and how far the weld is off it.

    The bead has one width all around, so that a border counts even where the other one is lost in what lies
    beside the bead. Least squares with Cauchy weights, times presence; where the borders are uncertain, the
    radius leans on what is known of it. The distances (84,) of the weld's centre line from the circle are in
    px of the reduced picture.
    """
    width = sectors.is_bead.astype(np.float64)
    basis = np.concatenate([np.column_stack([_AROUND, -width]), np.column_stack([_AROUND, width])])
    borders = np.concatenate([sectors.inner, sectors.outer])
    trust = np.tile(sectors.presence**2 + 1e-6, 2)
    seen = trust >= 0.25 * trust.max()
    weight, ridge, known = trust, 1e-6 * np.eye(basis.shape[1]), 0.0
    for _ in range(ROUNDS):
        weighted = basis * weight[:, None]
        normal, target = basis.T @ weighted + ridge, weighted.T @ borders
        normal[RADIUS, RADIUS] += known
        target[RADIUS] += known * (prior.radius_px - circle.radius)
        fit = np.linalg.solve(normal, target)
        residual = borders - basis @ fit
        scale = 2.0 * np.median(np.abs(residual[seen])) + SMALLEST_PX
        weight = trust / (1 + (residual / scale) ** 2)
        known = ALIKE * (scale / prior.deviation_px) ** 2
    moved = Circle(circle.x + float(fit[0]), circle.y + float(fit[1]), circle.radius + float(fit[2]))
    return moved, sectors.middle - _AROUND @ fit[:3]

"""Find the weld's circle in a frame, with sub-pixel centre and radius; never guess.

The circle's radius is known within a few per cent, so bores and grooves of other sizes cannot be taken for it. Steps:

1. coarse: a map of fine structure at 1/8 size, correlated with a ring; weld and bare joint both show as a ridge.
2. fine: a band round that circle is flattened; a network trained on rendered welds says for each of 84 sectors how far off the
   weld's centre line runs, and whether there is weld or joint at all; a circle is fitted to them, outliers weighed down. Twice.
3. support: the share of sectors that are there and lie on the circle; if it is low, there is no weld.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import Image, Ring
from station.errors import LocateError
from station.vision.polar import SECTORS, polar_band
from station.vision.unwrap import in_view

Field = NDArray[np.float32]
Array = NDArray[np.float64]
SectorFinder = Callable[[Image], tuple[Array, Array]]
"""Band (192, 672) uint8 to offsets in px (84,), outwards positive, and presence 0..1 (84,)."""

SCALE = 8
MIN_COARSE = 0.22
MIN_PRESENCE = 0.5
MIN_SUPPORT = 0.65
NEAR_PX = 12.0

_SECTOR_RAD = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
_BASIS = np.stack([np.cos(_SECTOR_RAD), np.sin(_SECTOR_RAD), np.ones(SECTORS)], axis=1)


@dataclass(frozen=True, slots=True)
class Expected:
    """What is known of the weld before looking, in pixels of the image."""

    radius_px: float = 428.0
    tolerance_px: float = 12.0


def locate(image: Image, expected: Expected, find_sectors: SectorFinder) -> Ring:
    """Ring of the weld in `image` (H, W) uint8.

    Raises LocateError if no weld is seen, or if its strip is not wholly in view; ModelError if the network fails.
    """
    height, width = image.shape
    reach = 2 * (expected.radius_px + expected.tolerance_px)
    if width < reach or height < reach:
        raise LocateError(
            f"no weld found: {width} x {height} px cannot hold a ring of {expected.radius_px:.0f} px radius"
        )
    x, y, ridge = _coarse(image, expected)
    if ridge < MIN_COARSE:
        raise LocateError(f"no weld found: the best ring scores {ridge:.2f}, needed {MIN_COARSE}")
    radius = expected.radius_px
    for _ in range(2):
        offset, presence = find_sectors(polar_band(image, x, y, radius))
        fit = _robust_fit(offset, presence)
        residual = offset - _BASIS @ fit
        on_circle = (presence >= MIN_PRESENCE) & (np.abs(residual) <= NEAR_PX)
        support = float(np.mean(on_circle))
        x, y, radius = x + fit[0], y + fit[1], radius + fit[2]
    if support < MIN_SUPPORT:
        raise LocateError(
            f"no weld found: only {support:.0%} of the best circle shows weld or joint, needed {MIN_SUPPORT:.0%}"
        )
    if abs(radius - expected.radius_px) > expected.tolerance_px:
        raise LocateError(
            f"no weld found: the best circle has {radius:.0f} px radius, needed {expected.radius_px:.0f} px"
        )
    ring = Ring(float(x), float(y), float(radius), support, float(np.sqrt(np.mean(residual[on_circle] ** 2))))
    if not in_view(ring, width, height):
        raise LocateError(f"the weld at ({x:.0f}, {y:.0f}) px is not wholly in view", out_of_view=True)
    return ring


def _coarse(image: Image, expected: Expected) -> tuple[float, float, float]:
    """Centre x, y in image pixels and the ridge score of the best ring at 1/8 size."""
    half = cv2.resize(image, None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    smooth = cv2.blur(half, (9, 9))
    fine = cv2.resize(cv2.absdiff(half, smooth), None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA).astype(
        np.float32
    )
    level = cv2.resize(smooth, (fine.shape[1], fine.shape[0]), interpolation=cv2.INTER_AREA).astype(
        np.float32
    )
    field = np.log1p(fine / (0.02 * level + 0.5))
    best = (0.0, 0.0, -np.inf)
    for radius_px in expected.radius_px + expected.tolerance_px * np.array([-1.0, 0.0, 1.0]):
        radius = radius_px / SCALE
        score = cv2.filter2D(field, -1, _ring_kernel(radius), borderType=cv2.BORDER_REFLECT)
        edge = int(radius)
        inner = score[edge : score.shape[0] - edge, edge : score.shape[1] - edge]
        if inner.size == 0:
            continue
        row, column = np.unravel_index(int(inner.argmax()), inner.shape)
        if inner[row, column] > best[2]:
            best = (
                float((column + edge + 0.5) * SCALE - 0.5),
                float((row + edge + 0.5) * SCALE - 0.5),
                float(inner[row, column]),
            )
    return best


def _ring_kernel(radius: float, width: float = 4.0) -> Field:
    """Ridge along a circle, with negative flanks, sum 0."""
    half = int(radius + 3 * width) + 1
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    away = np.hypot(x, y) - radius
    ridge = np.exp(-0.5 * (away / width) ** 2)
    flanks = np.exp(-0.5 * ((np.abs(away) - 2.6 * width) / (0.6 * width)) ** 2)
    return np.asarray(ridge / ridge.sum() - flanks / flanks.sum(), np.float32)


def _robust_fit(offset: Array, presence: Array) -> Array:
    """(dx, dy, dr) of offset = dx cos + dy sin + dr by reweighted least squares with Cauchy weights."""
    trust = presence + 1e-3
    weight = trust
    fit = np.zeros(3)
    for _ in range(8):
        root = np.sqrt(weight)
        fit = np.linalg.lstsq(_BASIS * root[:, None], offset * root, rcond=None)[0]
        residual = offset - _BASIS @ fit
        weight = trust / (1 + (residual / (2.0 * np.median(np.abs(residual)) + 0.3)) ** 2)
    return np.asarray(fit)

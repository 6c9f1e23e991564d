"""Finds the ring of the weld in a frame with sub-pixel centre and radius, or raises an error.

The radius is known within a few per cent, so bores and grooves of other sizes are not mistaken for the weld.
Steps:

1. coarse: a map of fine structure at 1/8 size is correlated with a ring; weld and bare joint both show as a
   ridge.
2. fine, done twice: a band around that circle is unwrapped. For each of its 84 sectors a network, trained on
   rendered welds, gives the offset of the weld's centre line and the probability that weld or joint is
   present. A circle is fitted to the offsets, with low weights for outliers.
3. support: the fraction of sectors in which weld or joint is present and lies on the circle. If it is low, no
   weld was found."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import NETWORK_UM_PER_PX, Image, Ring
from station.errors import LocateError
from station.vision.polar import SECTORS, polar_band
from station.vision.unwrap import in_view

Field = NDArray[np.float32]
Array = NDArray[np.float64]
SectorFinder = Callable[[Image], tuple[Array, Array]]
"""Function from a band (192, 672) uint8 to offsets in px (84,), positive outwards, and presence 0 to 1
(84,)."""

SCALE = 8
"""Factor by which the image is reduced for the coarse step."""
MIN_COARSE = 0.22
"""Minimum score of the best ring in the coarse step."""
MIN_PRESENCE = 0.5
"""Minimum presence of a sector that counts as weld or joint."""
MIN_SUPPORT = 0.65
"""Minimum fraction of the sectors that lie on the circle."""
NEAR_PX = 12.0
"""Maximum distance from the circle of a sector that lies on it."""

_SECTOR_RAD = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
_BASIS = np.stack([np.cos(_SECTOR_RAD), np.sin(_SECTOR_RAD), np.ones(SECTORS)], axis=1)


@dataclass(frozen=True, slots=True)
class Expected:
    """Expected radius of the weld and its tolerance, in pixels of the image."""

    radius_px: float = 428.0
    tolerance_px: float = 12.0


@dataclass(frozen=True, slots=True, eq=False)
class Located:
    """A ring, and where on it weld or joint was seen."""

    ring: Ring
    presence: Array
    """Presence (84,) float64, 0 to 1, of weld or joint on the circle in each sector, 0 where it lies off the
    circle; sector i covers [i, i + 1) * 360 / 84 degrees."""


def locate(image: Image, expected: Expected, find_sectors: SectorFinder) -> Located:
    """Return the ring of the weld in `image` (height, width) uint8, and where weld or joint lies on it.

    The scale of the image is 13 µm/px.

    Raises LocateError if no weld is found or its strip is not wholly in view, ModelError if the network
    fails.
    """
    height, width = image.shape
    reach = 2 * (expected.radius_px + expected.tolerance_px)
    if width < reach or height < reach:
        raise LocateError(
            f"no weld found: {width} x {height} px is too small for a radius of {expected.radius_px:.0f} px"
        )
    x, y, ridge = _coarse(image, expected)
    if ridge < MIN_COARSE:
        raise LocateError(f"no weld found: the best ring scores {ridge:.2f}, the minimum is {MIN_COARSE}")
    radius = expected.radius_px
    for _ in range(2):
        offset, presence = find_sectors(polar_band(image, x, y, radius))
        fit = _robust_fit(offset, presence)
        residual = offset - _BASIS @ fit
        near = np.abs(residual) <= NEAR_PX
        on_circle = (presence >= MIN_PRESENCE) & near
        support = float(np.mean(on_circle))
        x, y, radius = x + fit[0], y + fit[1], radius + fit[2]
    if support < MIN_SUPPORT:
        raise LocateError(
            f"no weld found: weld or joint on {support:.0%} of the best circle, minimum is {MIN_SUPPORT:.0%}"
        )
    if abs(radius - expected.radius_px) > expected.tolerance_px:
        raise LocateError(
            f"no weld found: the best radius is {radius:.0f} px, expected {expected.radius_px:.0f} px"
        )
    ring = Ring(
        float(x),
        float(y),
        float(radius),
        support,
        residual_px=float(np.sqrt(np.mean(residual[on_circle] ** 2))),
    )
    if not in_view(ring, width, height, um_per_px=NETWORK_UM_PER_PX):
        raise LocateError(f"the weld at ({x:.0f}, {y:.0f}) px is not wholly in view", out_of_view=True)
    return Located(ring, np.where(near, presence, 0.0))


def _coarse(image: Image, expected: Expected) -> tuple[float, float, float]:
    """Return centre x and y in image pixels and the score of the best ring at 1/8 size."""
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
    """Return a ridge along a circle with negative flanks; its sum is 0."""
    half = int(radius + 3 * width) + 1
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    away = np.hypot(x, y) - radius
    ridge = np.exp(-0.5 * (away / width) ** 2)
    flanks = np.exp(-0.5 * ((np.abs(away) - 2.6 * width) / (0.6 * width)) ** 2)
    return np.asarray(ridge / ridge.sum() - flanks / flanks.sum(), np.float32)


def _robust_fit(offset: Array, presence: Array) -> Array:
    """Return (dx, dy, dr) of offset = dx cos + dy sin + dr, by least squares with Cauchy weights."""
    trust = presence + 1e-3
    weight = trust
    fit = np.zeros(3)
    for _ in range(8):
        root = np.sqrt(weight)
        fit = np.linalg.lstsq(_BASIS * root[:, None], offset * root, rcond=None)[0]
        residual = offset - _BASIS @ fit
        weight = trust / (1 + (residual / (2.0 * np.median(np.abs(residual)) + 0.3)) ** 2)
    return np.asarray(fit)

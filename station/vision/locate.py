"""Finds the ring of the weld in a frame with sub-pixel centre and radius, or raises an error.

The radius is known within a few per cent, so bores and grooves of other sizes are not mistaken for the weld.
Steps:

1. marks: a network, trained on rendered welds, says how much of each cell of the frame at 52 µm/px is covered
   by bead and by bare joint.
2. vote: the circle of the expected radius with most weld on it and least beside it.
3. fit: around that circle the middle between the bead's borders is read in 84 sectors, and a circle is fitted
   to them, with low weights for outliers; a few times, each time around the circle of the last.
4. support: the fraction of sectors in which weld or joint lies on the circle. If it is low, no weld was
   found."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.domain import Image, Ring
from station.errors import LocateError
from station.vision.circle import Prior, fit_circle
from station.vision.marks import Marks
from station.vision.polar import Array, read_sectors
from station.vision.reduced import FINDER_UM_PER_PX, Circle, reduce_to_finder
from station.vision.unwrap import in_view
from station.vision.vote import best_circle, radii_within

MarkFinder = Callable[[Image], Marks]
"""Function from a picture (height, width) uint8 at 52 µm/px to the marks on it."""

MIN_VOTE = 0.25
"""Minimum vote of the best circle."""
MIN_PRESENCE = 0.5
"""Minimum covered fraction in a sector that counts as weld or joint."""
MIN_SUPPORT = 0.55
"""Minimum fraction of the sectors that lie on the circle."""
NEAR_MM = 0.25
"""Maximum distance from the circle of a sector that lies on it."""
MAX_ROUNDS = 4
"""Maximum number of fits."""
STILL_PX = 0.02
"""Movement in px of the reduced picture below which a fit is the last."""
OTHER_RADII_MM = tuple(float(value) for value in np.arange(1.5, 9.01, 0.25))
"""Radii of other rings, which are named where none of the expected radius is found."""
MIN_OTHER_VOTE = 0.5
"""Minimum vote of a ring of another radius that is worth naming."""

_NEAR_PX = NEAR_MM * 1000 / FINDER_UM_PER_PX


@dataclass(frozen=True, slots=True)
class Expected:
    """Expected radius of the weld and its tolerance."""

    radius_mm: float = 5.564
    tolerance_mm: float = 0.156


@dataclass(frozen=True, slots=True, eq=False)
class Located:
    """The ring of a weld and where on it weld or joint was seen."""

    ring: Ring
    presence: Array
    """Covered fraction (84,) float64, 0 to 1, of weld or joint on the circle in each sector, 0 where it lies
    off the circle; sector i covers [i, i + 1) * 360 / 84 degrees."""


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    circle: Circle
    residual_px: Array
    presence: Array

    @property
    def near(self) -> NDArray[np.bool_]:
        return np.abs(self.residual_px) <= _NEAR_PX

    @property
    def on_circle(self) -> NDArray[np.bool_]:
        return (self.presence >= MIN_PRESENCE) & self.near

    @property
    def support(self) -> float:
        return float(np.mean(self.on_circle))

    @property
    def radius_mm(self) -> float:
        return self.circle.radius * FINDER_UM_PER_PX / 1000


def locate(image: Image, expected: Expected, find_marks: MarkFinder, *, um_per_px: float) -> Located:
    """Return the ring of the weld in `image` (height, width) uint8, whose scale is `um_per_px`.

    Raises LocateError if no weld is found or its strip is not wholly in view, ModelError if the network
    fails.
    """
    height, width = image.shape
    reach = 2 * (expected.radius_mm + expected.tolerance_mm) * 1000 / um_per_px
    if width < reach or height < reach:
        raise LocateError(
            f"no weld found: {width} x {height} px is too small for a radius of {expected.radius_mm:.2f} mm"
        )
    reduced = reduce_to_finder(image, um_per_px)
    marks = find_marks(reduced.image)
    fit = _search(marks, expected)
    circle = reduced.in_frame(fit.circle)
    px = circle.radius / fit.circle.radius
    on_circle = fit.on_circle
    ring = Ring(
        circle.x,
        circle.y,
        circle.radius,
        fit.support,
        residual_px=px * float(np.sqrt(np.mean(fit.residual_px[on_circle] ** 2))),
    )
    if not in_view(ring, width, height, um_per_px=um_per_px):
        place = f"({circle.x:.0f}, {circle.y:.0f}) px"
        raise LocateError(f"the weld at {place} is not wholly in view", out_of_view=True)
    return Located(ring, np.where(fit.near, fit.presence, 0.0))


def _search(marks: Marks, expected: Expected) -> _Fit:
    """Return the fitted circle of the expected radius. Raises LocateError."""
    vote = best_circle(marks.areas(), radii_within(expected.radius_mm, expected.tolerance_mm))
    if vote.score < MIN_VOTE:
        raise _not_found(f"the best circle scores {vote.score:.2f}, minimum is {MIN_VOTE}", marks, expected)
    fit = _fit(marks, vote.circle, _prior(expected.radius_mm, expected.tolerance_mm / 2))
    if fit.support < MIN_SUPPORT:
        found = f"weld or joint on {fit.support:.0%} of the best circle, minimum is {MIN_SUPPORT:.0%}"
        raise _not_found(found, marks, expected)
    if abs(fit.radius_mm - expected.radius_mm) > expected.tolerance_mm:
        raise LocateError(f"no weld found: a ring of {fit.radius_mm:.2f} mm; {_words(expected)}")
    return fit


def _prior(radius_mm: float, deviation_mm: float) -> Prior:
    px = 1000 / FINDER_UM_PER_PX
    return Prior(radius_mm * px, deviation_mm * px)


def _fit(marks: Marks, circle: Circle, prior: Prior) -> _Fit:
    for _ in range(MAX_ROUNDS):
        before = circle
        sectors = read_sectors(marks, circle)
        circle, residual_px = fit_circle(circle, sectors, prior)
        if (
            max(abs(circle.x - before.x), abs(circle.y - before.y), abs(circle.radius - before.radius))
            < STILL_PX
        ):
            break
    return _Fit(circle, residual_px, sectors.presence)


def _not_found(what: str, marks: Marks, expected: Expected) -> LocateError:
    """Return the error, which names a ring of another radius if there is one."""
    other = best_circle(marks.areas(), OTHER_RADII_MM)
    if other.score >= MIN_OTHER_VOTE:
        fit = _fit(marks, other.circle, Prior(other.circle.radius, _NEAR_PX))
        apart = abs(fit.radius_mm - expected.radius_mm) > expected.tolerance_mm
        if apart and fit.support >= MIN_SUPPORT:
            what = f"a ring of {fit.radius_mm:.2f} mm; {_words(expected)}"
    return LocateError(f"no weld found: {what}")


def _words(expected: Expected) -> str:
    return f"expected {expected.radius_mm:.2f} +- {expected.tolerance_mm:.2f} mm"

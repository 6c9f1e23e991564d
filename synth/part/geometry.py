"""The two forms of a weld: a whole ring, or the paper's straight piece of one. numpy only, mm.

Both are described by an angle along the weld and a radius across it. They differ in where these lie on the
part, whether the weld closes, and how much of the part is there.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.floating[Any]]

RING_ANGLES = 3072
"""Angles of the bead's grid round the ring: 11 um apart."""
PIECE_MM = 2.4
"""Side of the square of partners that is modelled round a straight piece."""
PIECE_LENGTH_MM = 2.0
"""Length of the weld on it."""


@dataclass(frozen=True, slots=True)
class Geometry(ABC):
    """Form of a weld whose centre line has the radius `radius_mm`."""

    radius_mm: float
    is_closed: ClassVar[bool]
    """True if the weld's end meets its start."""
    plate_mm: ClassVar[float]
    """Side of the square that the partners' texture covers."""
    plate_texels: ClassVar[int]
    """Pixels along that side."""

    @property
    @abstractmethod
    def length_mm(self) -> float:
        """Length of the weld."""

    @property
    @abstractmethod
    def ends_rad(self) -> tuple[float, float]:
        """First and last angle of the weld."""

    @property
    def period_rad(self) -> float | None:
        """Angle after which the weld repeats, if it closes."""
        return 2 * np.pi if self.is_closed else None

    def clipped(self, start_rad: float, end_rad: float) -> tuple[float, float]:
        """Return the part of an arc that the weld has; the end lies before the start if it has none."""
        if self.is_closed:
            return start_rad, end_rad
        first, last = self.ends_rad
        return max(start_rad, first), min(end_rad, last)

    @abstractmethod
    def angles(self) -> Array:
        """Return the angles (M,) of the bead's grid, rad."""

    @abstractmethod
    def embed(self, theta_rad: Array, radius_mm: Array, z_mm: Array) -> Array:
        """Return weld coordinates as part coordinates (x right, y down, z to the camera), (..., 3)."""

    @abstractmethod
    def weld_coordinates(self, x_mm: Floats, y_mm: Floats) -> tuple[Floats, Floats]:
        """Return the angle in rad and the radius in mm of points of the part: the inverse of `embed`."""

    @abstractmethod
    def partner_edges_mm(self, theta_rad: Array) -> tuple[Array, Array]:
        """Return the radius (M,) at which the inner and the outer partner end."""

    @abstractmethod
    def along(self, points: Array) -> Array:
        """Return the difference of neighbours along the weld of a grid of points (K, M, 3), same shape."""

    @abstractmethod
    def number(self, rng: np.random.Generator, on_ring: int, piece_fraction: float) -> int:
        """Return how many of the `on_ring` things of a ring are here; a piece has that fraction of them."""


@dataclass(frozen=True, slots=True)
class Ring(Geometry):
    """A weld that is a whole ring round the origin, angle 0 at +x."""

    is_closed = True
    plate_mm = 24.0
    plate_texels = 1536

    @property
    def length_mm(self) -> float:
        """Length of the weld."""
        return 2 * np.pi * self.radius_mm

    @property
    def ends_rad(self) -> tuple[float, float]:
        """First and last angle of the weld."""
        return 0.0, 2 * np.pi

    def angles(self) -> Array:
        """Return the angles (M,) of the bead's grid, rad."""
        return np.arange(RING_ANGLES, dtype=np.float64) * (2 * np.pi / RING_ANGLES)

    def embed(self, theta_rad: Array, radius_mm: Array, z_mm: Array) -> Array:
        """Return weld coordinates as part coordinates."""
        theta_rad, radius_mm, z_mm = np.broadcast_arrays(theta_rad, radius_mm, z_mm)
        return np.stack([radius_mm * np.cos(theta_rad), radius_mm * np.sin(theta_rad), z_mm], axis=-1)

    def weld_coordinates(self, x_mm: Floats, y_mm: Floats) -> tuple[Floats, Floats]:
        """Return the angle and the radius of points of the part."""
        return np.arctan2(y_mm, x_mm), np.hypot(x_mm, y_mm)

    def partner_edges_mm(self, theta_rad: Array) -> tuple[Array, Array]:
        """Return the middle, and a rectangle of 22 x 20 mm with round corners (a superellipse)."""
        rim = (np.abs(np.cos(theta_rad) / 11.0) ** 10 + np.abs(np.sin(theta_rad) / 10.0) ** 10) ** -0.1
        return np.zeros_like(theta_rad), np.asarray(rim)

    def along(self, points: Array) -> Array:
        """Return the difference of neighbours along the weld, across its seam too."""
        return np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)

    def number(self, rng: np.random.Generator, on_ring: int, piece_fraction: float) -> int:
        """Return all of them."""
        return on_ring


@dataclass(frozen=True, slots=True)
class StraightPiece(Geometry):
    """A straight piece of weld round angle 0: the angle runs along x, the radius upwards, as in the strip."""

    is_closed = False
    plate_mm = PIECE_MM
    plate_texels = 256

    @property
    def length_mm(self) -> float:
        """Length of the weld."""
        return PIECE_LENGTH_MM

    @property
    def ends_rad(self) -> tuple[float, float]:
        """First and last angle of the weld."""
        half = PIECE_LENGTH_MM / 2 / self.radius_mm
        return -half, half

    def angles(self) -> Array:
        """Return the angles (M,) of the bead's grid, rad."""
        start, end = self.ends_rad
        return np.linspace(start, end, round(RING_ANGLES * end / np.pi))

    def embed(self, theta_rad: Array, radius_mm: Array, z_mm: Array) -> Array:
        """Return weld coordinates as part coordinates."""
        theta_rad, radius_mm, z_mm = np.broadcast_arrays(theta_rad, radius_mm, z_mm)
        return np.stack([theta_rad * self.radius_mm, self.radius_mm - radius_mm, z_mm], axis=-1)

    def weld_coordinates(self, x_mm: Floats, y_mm: Floats) -> tuple[Floats, Floats]:
        """Return the angle and the radius of points of the part."""
        return x_mm / self.radius_mm, self.radius_mm - y_mm

    def partner_edges_mm(self, theta_rad: Array) -> tuple[Array, Array]:
        """Return the lower and the upper side of the square of partners."""
        middle = np.full_like(theta_rad, self.radius_mm)
        return middle - PIECE_MM / 2, middle + PIECE_MM / 2

    def along(self, points: Array) -> Array:
        """Return the difference of neighbours along the weld."""
        return np.asarray(np.gradient(points, axis=1))

    def number(self, rng: np.random.Generator, on_ring: int, piece_fraction: float) -> int:
        """Return a number drawn round the piece's fraction of them."""
        return int(rng.poisson(on_ring * piece_fraction))

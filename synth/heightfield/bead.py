"""The bead of one part: its course, cross-section, ends, skin and what is missing of it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.heightfield.grid import Field, noise, smooth_step
from synth.heightfield.surface import Place, Surface
from synth.heightfield.weld import FAMILIES
from synth.part.ranges import log_uniform, uniform

REACH = 1.6
"""How far from the centre line the bead's relief is computed, in half-widths."""


@dataclass(frozen=True, slots=True)
class Course:
    """Where a bead runs: a circle round (x, y), mm, and the angles between which it is missing."""

    x_mm: float
    y_mm: float
    radius_mm: float
    half_width_mm: float
    start_deg: float
    direction: int
    """+1: welded clockwise as seen in the image, -1: the other way."""
    overlap_mm: float
    missing_deg: tuple[tuple[float, float], ...] = ()
    """Start and end of each arc without bead; the end may exceed 360."""


Index = tuple[NDArray[np.intp], ...]
"""Rows and columns of chosen cells."""


@dataclass(frozen=True, slots=True, eq=False)
class BeadCells:
    """The cells near a bead: their indices, and weld coordinates of each; all (K,)."""

    index: Index
    s_mm: Field
    across: Field
    angle_deg: Field


def lay_bead(
    rng: np.random.Generator,
    surface: Surface,
    course: Course,
    families: Sequence[str],
    *,
    steepness: float = 1.0,
) -> tuple[str, BeadCells]:
    """Weld a bead onto the part; return the name of its family, drawn from `families`, and its cells.

    `steepness` is the factor of its height.
    """
    family = str(rng.choice(list(families)))
    dx, dy = surface.x_mm - np.float32(course.x_mm), surface.y_mm - np.float32(course.y_mm)
    away = np.hypot(dx, dy) - np.float32(course.radius_mm)
    near = np.nonzero(np.abs(away) < REACH * course.half_width_mm)
    angle = np.arctan2(dy[near], dx[near])
    degrees = np.rad2deg(angle) % 360
    turned = np.deg2rad((degrees - course.start_deg) * course.direction % 360)
    s_mm = (turned * course.radius_mm).astype(np.float32)
    half = _half_width(rng, angle, course)
    across = away[near] / half
    # the second pass of the overlap lies over the first, with a round nose
    nose = course.overlap_mm - course.half_width_mm * (
        1 - np.sqrt(np.maximum(1 - np.clip(across, -1, 1) ** 2, 0))
    )
    second = s_mm < nose
    s_mm = np.where(second, s_mm + np.float32(2 * np.pi * course.radius_mm), s_mm).astype(np.float32)
    left = _left(degrees, across, course)
    edge = log_uniform(rng, (0.01, 0.15))
    inside = (1 - smooth_step(np.abs(across), 1 - edge, 1 + edge)) * left
    relief = FAMILIES[family](rng, s_mm, across.astype(np.float32), course.half_width_mm)
    relief = (
        relief
        * np.float32(log_uniform(rng, (0.4, 1.4)))
        * (1 - uniform(rng, (0, 0.9)) * np.minimum(np.abs(across), 1) ** 3)
    )
    own = _cross_section(rng, s_mm, across, course) + relief
    own += second * _raised(rng, across) + _crater(rng, s_mm, across, course)
    own *= np.float32(steepness)
    base = _base(surface, course, near, away[near])
    surface.height_mm[near] += inside * (base + own - surface.height_mm[near])
    surface.height_mm[near] -= left * _undercut(rng, s_mm, across)
    _skin(rng, surface, near, s_mm, across, inside)
    place = surface.place[near]
    surface.place[near] = np.where(inside > 0.5, Place.BEAD, np.where(left > 0.5, np.uint8(0), place))
    bare = surface.place == Place.BARE_JOINT
    bare[near] &= left < 0.5
    surface.place[(surface.place == Place.BARE_JOINT) & ~bare] = Place.OTHER
    return family, BeadCells(near, s_mm, across.astype(np.float32), degrees.astype(np.float32))


def _half_width(rng: np.random.Generator, angle: Field, course: Course) -> Field:
    """Return half the bead's width at each angle, mm: it wanders, and may be ragged."""
    x, y = (np.float32(course.radius_mm) * turn for turn in (np.cos(angle), np.sin(angle)))
    slow_mm, ragged_mm = log_uniform(rng, (1, 8)), log_uniform(rng, (0.06, 0.5))
    slow = uniform(rng, (0, 0.1)) * noise(rng, x, y, (slow_mm, slow_mm))
    ragged = uniform(rng, (0, 0.09)) * (rng.random() < 0.6) * noise(rng, x, y, (ragged_mm, ragged_mm))
    return np.asarray(course.half_width_mm * np.clip(1 + slow + ragged, 0.5, 1.5), np.float32)


def _left(degrees: Field, across: Field, course: Course) -> Field:
    """Return 1 where the bead is, 0 where it is missing, with round ends of the bead."""
    left = np.ones_like(across)
    for start, end in course.missing_deg:
        middle, half = (start + end) / 2, (end - start) / 2
        off = np.abs((degrees - middle + 180) % 360 - 180)
        if half >= 179.9:
            return np.zeros_like(across)
        inside_mm = np.deg2rad(half - off) * course.radius_mm
        round_mm = 0.5 * course.half_width_mm * (1 - np.sqrt(np.maximum(1 - np.clip(across, -1, 1) ** 2, 0)))
        left = np.minimum(left, 1 - smooth_step(inside_mm + round_mm, -0.02, 0.02))
    return np.asarray(left, np.float32)


def _base(surface: Surface, course: Course, near: Index, away: Field) -> Field:
    """Return the height between the two sheets, on which the bead stands."""
    inner = surface.height_mm[near][away < -1.3 * course.half_width_mm]
    outer = surface.height_mm[near][away > 1.3 * course.half_width_mm]
    low, high = (float(np.median(side)) if side.size else 0.0 for side in (inner, outer))
    weight = smooth_step(away, -course.half_width_mm, course.half_width_mm)
    return np.asarray(low + (high - low) * weight, np.float32)


def _cross_section(rng: np.random.Generator, s_mm: Field, across: Field, course: Course) -> Field:
    """Return the profile from border to border: convex, flat or concave, leaning, changing along the weld."""
    crown = uniform(rng, (-0.04, 0.12)) if rng.random() < 0.65 else uniform(rng, (-0.008, 0.012))
    power = uniform(rng, (1.6, 5.0))
    lean = uniform(rng, (-0.3, 0.3)) * abs(crown)
    change = 1 + uniform(rng, (0, 0.5)) * noise(
        rng, s_mm, np.zeros_like(s_mm), (log_uniform(rng, (1, 8)), 1.0)
    )
    profile = crown * (1 - np.minimum(np.abs(across), 1) ** power) + lean * np.clip(across, -1, 1)
    return np.asarray(profile * change, np.float32)


def _raised(rng: np.random.Generator, across: Field) -> Field:
    return np.asarray(uniform(rng, (-0.01, 0.04)) * (1 - np.minimum(np.abs(across), 1) ** 2), np.float32)


def _crater(rng: np.random.Generator, s_mm: Field, across: Field, course: Course) -> Field:
    """Return the crater at the weld's end, with its lip."""
    end = 2 * np.pi * course.radius_mm + course.overlap_mm - 0.5 * course.half_width_mm
    rho = np.hypot(s_mm - np.float32(end), across * np.float32(course.half_width_mm)) / np.float32(
        course.half_width_mm
    )
    bowl = np.exp(-((rho / 0.5) ** 2)) - 0.4 * np.exp(-(((rho - 0.85) / 0.15) ** 2))
    return np.asarray(-uniform(rng, (0.0, 0.09)) * bowl, np.float32)


def _undercut(rng: np.random.Generator, s_mm: Field, across: Field) -> Field:
    depth = uniform(rng, (0, 0.05)) * (rng.random() < 0.6)
    where = np.exp(-(((np.abs(across) - 1.02) / uniform(rng, (0.03, 0.1))) ** 2))
    change = np.clip(0.5 + 0.6 * noise(rng, s_mm, across, (0.8, 3.0)), 0, 2)
    return np.asarray(depth * where * change, np.float32)


def _skin(
    rng: np.random.Generator, surface: Surface, near: Index, s_mm: Field, across: Field, inside: Field
) -> None:
    """Give the bead its own reflectance and roughness, with oxide or soot in patches or along its borders."""
    like_sheet = rng.random() < 0.35
    of_sheet = float(np.median(surface.reflectance[near])) * uniform(rng, (0.85, 1.2))
    own = min(of_sheet, 1.0) if like_sheet else uniform(rng, (0.3, 1.0))
    reflectance = np.full_like(s_mm, own)
    reflectance *= np.exp(np.float32(uniform(rng, (0, 0.15))) * noise(rng, s_mm, across, (0.5, 0.5)))
    if rng.random() < 0.45:
        patch = noise(rng, s_mm, across, (log_uniform(rng, (0.3, 4)), log_uniform(rng, (0.3, 1.5))))
        low = uniform(rng, (-0.3, 1.2))
        soot = smooth_step(patch, low, low + log_uniform(rng, (0.15, 1.5))) * np.float32(
            uniform(rng, (0.2, 0.9))
        )
        reflectance += soot * (np.float32(uniform(rng, (0.03, 0.3))) - reflectance)
    if rng.random() < 0.4:
        border = smooth_step(np.abs(across), uniform(rng, (0.4, 0.9)), 1.0) * np.float32(
            uniform(rng, (0.1, 0.8))
        )
        reflectance *= 1 - border * np.clip(0.6 + 0.5 * noise(rng, s_mm, across, (1.0, 1.0)), 0, 1)
    of_sheet = float(np.median(surface.roughness[near])) * uniform(rng, (0.8, 1.25))
    rough = of_sheet if like_sheet else log_uniform(rng, (0.07, 0.4))
    patchy = np.exp(np.float32(uniform(rng, (0, 0.3))) * noise(rng, s_mm, across, (0.6, 0.6)))
    surface.reflectance[near] += inside * (reflectance - surface.reflectance[near])
    surface.roughness[near] += inside * (np.float32(rough) * patchy - surface.roughness[near])

"""Holes in the bead as relief, by family: walls, floors and lips. Not used by the paper's protocol."""

from dataclasses import dataclass

import numpy as np

from synth.heightfield.bead import BeadCells, Course
from synth.heightfield.grid import noise, smooth_step
from synth.heightfield.surface import Place, Surface
from synth.part.ranges import log_uniform, uniform


@dataclass(frozen=True, slots=True)
class HoleFamily:
    """Ranges of one family of holes; lengths in mm."""

    length_mm: tuple[float, float]
    aspect: tuple[float, float]
    """Length along the weld by width across it."""
    depth: tuple[float, float]
    """Depth by width."""
    wall: tuple[float, float]
    """Width of the wall by half the hole's width."""
    floor_reflectance: tuple[float, float]
    """Reflectance of the floor by that of the bead."""
    lip_mm: tuple[float, float]
    count: tuple[int, int] = (1, 1)


FAMILIES: dict[str, HoleFamily] = {
    "through": HoleFamily((0.08, 1.6), (0.8, 1.5), (1.0, 2.0), (0.05, 0.5), (0.0, 0.1), (-0.02, 0.01)),
    "blind": HoleFamily((0.08, 1.2), (0.8, 1.5), (0.25, 0.9), (0.15, 0.7), (0.5, 1.2), (-0.02, 0.01)),
    "blowhole": HoleFamily((0.1, 1.2), (0.8, 1.4), (0.4, 1.5), (0.1, 0.5), (0.02, 0.9), (0.01, 0.07)),
    "elongated": HoleFamily((0.4, 2.4), (2.0, 6.0), (0.3, 1.5), (0.1, 0.6), (0.0, 0.9), (-0.02, 0.02)),
    "cluster": HoleFamily(
        (0.06, 0.3), (0.8, 1.4), (0.4, 1.5), (0.1, 0.6), (0.0, 0.8), (-0.01, 0.01), (4, 14)
    ),
}
"""Families of holes by name."""


@dataclass(frozen=True, slots=True)
class DrilledHole:
    """One hole as it was made: its arc along the weld and its size."""

    family: str
    start_deg: float
    end_deg: float
    length_mm: float
    width_mm: float


def drill(
    rng: np.random.Generator, surface: Surface, course: Course, cells: BeadCells, name: str
) -> tuple[DrilledHole, ...]:
    """Make the hole, or the cluster of holes, of a family somewhere on the bead."""
    family = FAMILIES[name]
    middle_deg, middle_mm = uniform(rng, (0, 360)), uniform(rng, (-0.6, 0.6)) * course.half_width_mm
    made = []
    for number in range(int(rng.integers(family.count[0], family.count[1] + 1))):
        spread = 0.35 if number else 0.0
        at_deg = middle_deg + float(np.rad2deg(rng.normal() * spread / course.radius_mm))
        across = float(
            np.clip(
                middle_mm + rng.normal() * spread * 0.5,
                -0.75 * course.half_width_mm,
                0.75 * course.half_width_mm,
            )
        )
        hole = _one(rng, surface, course, cells, family=family, name=name, at_deg=at_deg, across_mm=across)
        if hole is not None:
            made.append(hole)
    return tuple(made)


def _one(
    rng: np.random.Generator,
    surface: Surface,
    course: Course,
    cells: BeadCells,
    *,
    family: HoleFamily,
    name: str,
    at_deg: float,
    across_mm: float,
) -> DrilledHole | None:
    length = log_uniform(rng, family.length_mm)
    width = min(length / uniform(rng, family.aspect), 1.3 * (course.half_width_mm - abs(across_mm)))
    depth = min(uniform(rng, family.depth) * width, 0.8)
    radius = course.radius_mm + across_mm
    along = np.deg2rad((cells.angle_deg - at_deg + 180) % 360 - 180) * np.float32(radius)
    across = cells.across * np.float32(course.half_width_mm) - np.float32(across_mm)
    chosen = np.nonzero((np.abs(along) < length + 0.2) & (np.abs(across) < width + 0.2))[0]
    if not chosen.size:
        return None
    along, across = along[chosen], across[chosen]
    shift = noise(rng, along, across, (max(0.5 * width, 0.05), max(0.5 * width, 0.05)))
    edge = np.hypot(along / np.float32(length / 2), across / np.float32(width / 2)) + 0.12 * shift
    away = (1 - edge) * np.float32(width / 2)  # inside positive, mm
    index = tuple(axis[chosen] for axis in cells.index)
    on_bead = (surface.place[index] == Place.BEAD) | (surface.place[index] == Place.HOLE)
    wall = max(uniform(rng, family.wall) * width / 2, surface.cell_mm)
    inside = smooth_step(away, 0.0, wall) * on_bead
    floor = uniform(rng, (0, 0.03)) * noise(rng, along, across, (0.06, 0.06))
    lip = (
        uniform(rng, family.lip_mm)
        * np.exp(-((away / max(0.25 * width, 0.02)) ** 2))
        * (away < 0.3 * wall)
        * on_bead
    )
    surface.height_mm[index] += np.asarray(inside * (floor - np.float32(depth)) + lip, np.float32)
    rest = uniform(rng, family.floor_reflectance)
    deep = smooth_step(away, 0.4 * wall, wall) * on_bead
    surface.reflectance[index] *= np.asarray(1 + deep * (rest - 1), np.float32)
    mask = (away > 0) & on_bead
    if not mask.any():
        return None
    surface.place[tuple(axis[mask] for axis in index)] = Place.HOLE
    half = float(np.rad2deg(length / 2 / radius))
    return DrilledHole(name, at_deg - half, at_deg + half, length, width)

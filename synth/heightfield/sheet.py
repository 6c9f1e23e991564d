"""Finishes of the sheets that are joined, each as relief: a function of a generator and a place."""

from collections.abc import Callable

import numpy as np

from synth.heightfield.grid import Field, noise, turned, with_slope
from synth.part.ranges import log_uniform, uniform

Finish = Callable[[np.random.Generator, Field, Field, float], Field]
"""Function of generator, x in mm, y in mm and cell in mm to the height in mm."""


def rolled(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return long, shallow streaks in one direction, of several grains."""
    u_mm, v_mm = turned(x, y, uniform(rng, (0, np.pi)))
    fine, coarse = log_uniform(rng, (2.2 * cell_mm, 0.15)), log_uniform(rng, (0.1, 0.8))
    height = noise(rng, u_mm, v_mm, (log_uniform(rng, (3, 20)), fine))
    height = height + uniform(rng, (0.5, 4)) * noise(rng, u_mm, v_mm, (log_uniform(rng, (3, 20)), coarse))
    return with_slope(height, cell_mm, log_uniform(rng, (0.01, 0.16)))


def brushed(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return steep, short streaks in nearly one direction."""
    angle = uniform(rng, (0, np.pi))
    height = np.zeros_like(x)
    for _ in range(3):
        u_mm, v_mm = turned(x, y, angle + rng.normal() * 0.06)
        height += noise(
            rng, u_mm, v_mm, (log_uniform(rng, (0.6, 5)), log_uniform(rng, (2.2 * cell_mm, 0.16)))
        )
    return with_slope(height, cell_mm, log_uniform(rng, (0.06, 0.45)))


def ground(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return streaks that cross each other."""
    first, second = brushed(rng, x, y, cell_mm), brushed(rng, x, y, cell_mm)
    return np.asarray(np.maximum(first, second) if rng.random() < 0.5 else first + second)


def milled(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return the arcs of an end mill whose centre advances: sharp crests, one pitch apart."""
    u_mm, v_mm = turned(x, y, uniform(rng, (0, 2 * np.pi)))
    radius = log_uniform(rng, (4, 60))
    v_mm = v_mm - np.float32(uniform(rng, (-0.6, 0.6)) * min(radius, 12))
    advance = u_mm - np.sqrt(np.maximum(np.float32(radius**2) - v_mm * v_mm, 0.0))
    height = _feed_marks(rng, advance, x, y, log_uniform(rng, (4 * cell_mm, 0.6)))
    if rng.random() < 0.4:
        back = u_mm + np.sqrt(np.maximum(np.float32(radius**2) - v_mm * v_mm, 0.0))
        height = height + uniform(rng, (0.2, 0.9)) * _feed_marks(
            rng, back, x, y, log_uniform(rng, (4 * cell_mm, 0.6))
        )
    return with_slope(height, cell_mm, log_uniform(rng, (0.03, 0.35)))


def turned_finish(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return the concentric grooves of a lathe, whose centre lies near the part's or away from it."""
    away = uniform(rng, (0, 0.4)) if rng.random() < 0.5 else uniform(rng, (0.4, 12))
    heading = uniform(rng, (0, 2 * np.pi))
    radius = np.hypot(x - np.float32(away * np.cos(heading)), y - np.float32(away * np.sin(heading)))
    height = _feed_marks(rng, radius, x, y, log_uniform(rng, (4 * cell_mm, 0.5)))
    return with_slope(height, cell_mm, log_uniform(rng, (0.03, 0.35)))


def blasted(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return the dimples of blasting: no direction."""
    grain = log_uniform(rng, (2.2 * cell_mm, 0.25))
    height = noise(rng, x, y, (grain, grain))
    if rng.random() < 0.5:
        height = -np.abs(height)
    return with_slope(np.asarray(height, np.float32), cell_mm, log_uniform(rng, (0.08, 0.5)))


def peeled(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return a wavy skin as of a plated or cast sheet, with a fine grain on it."""
    wave, grain = log_uniform(rng, (0.25, 1.5)), log_uniform(rng, (2.2 * cell_mm, 0.12))
    height = with_slope(noise(rng, x, y, (wave, wave)), cell_mm, log_uniform(rng, (0.01, 0.08)))
    return height + with_slope(noise(rng, x, y, (grain, grain)), cell_mm, log_uniform(rng, (0.01, 0.15)))


def hatched(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return the grid of spots or lines that laser cleaning leaves, or a knurl."""
    u_mm, v_mm = turned(x, y, uniform(rng, (0, np.pi)))
    pitch = log_uniform(rng, (5 * cell_mm, 0.5))
    other = pitch * uniform(rng, (0.7, 1.4))
    wander = np.float32(0.15 * pitch) * noise(rng, x, y, (1.0, 1.0))
    lines = np.cos(2 * np.pi * (u_mm + wander) / pitch)
    height = lines * np.cos(2 * np.pi * (v_mm + wander) / other) if rng.random() < 0.6 else lines
    return with_slope(np.asarray(height, np.float32), cell_mm, log_uniform(rng, (0.03, 0.3)))


def polished(rng: np.random.Generator, x: Field, y: Field, cell_mm: float) -> Field:
    """Return a nearly flat surface."""
    return with_slope(noise(rng, x, y, (3.0, 3.0)), cell_mm, log_uniform(rng, (0.002, 0.02)))


FINISHES: dict[str, Finish] = {
    "rolled": rolled,
    "brushed": brushed,
    "ground": ground,
    "milled": milled,
    "turned": turned_finish,
    "blasted": blasted,
    "peeled": peeled,
    "hatched": hatched,
    "polished": polished,
}
"""Finishes by name."""


def _feed_marks(rng: np.random.Generator, along: Field, x: Field, y: Field, pitch: float) -> Field:
    """Return round grooves with sharp crests between, of one pitch, with a second, slower wave."""
    wander = np.float32(0.2 * pitch) * noise(rng, x, y, (2.0, 2.0))
    phase = np.pi * (along + wander) / np.float32(pitch)
    strength = 1 + 0.4 * noise(rng, along, x, (pitch * 1.5, 6.0))
    slow = 0.5 * np.sin(phase / np.float32(uniform(rng, (1.5, 6.0))))
    return np.asarray(-np.abs(np.cos(phase)) * strength + slow, np.float32)

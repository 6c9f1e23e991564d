"""Turned plugs, as seal the filling hole of a battery: steps, chamfers and turned zones inside the weld."""

from itertools import pairwise

import numpy as np

from synth.heightfield.grid import Field, smooth_step
from synth.heightfield.sheets import Joint
from synth.heightfield.surface import Surface
from synth.part.ranges import log_uniform, uniform


def add_profile(rng: np.random.Generator, surface: Surface, joint: Joint, *, radius_mm: float) -> None:
    """Turn the disc within `radius_mm`: up to seven zones, each with its own height, grooves and shine."""
    x, y = (place + rng.normal() * 0.04 for place in (joint.x_mm, joint.y_mm))
    away = np.hypot(surface.x_mm - np.float32(x), surface.y_mm - np.float32(y))
    borders = np.sort(rng.uniform(0.05, 1.0, int(rng.integers(1, 7)))) * radius_mm
    zones = [0.0, *(float(border) for border in borders), radius_mm]
    for inner, outer in pairwise(zones):
        _turn(rng, surface, away, inner=inner, outer=outer)


def _turn(rng: np.random.Generator, surface: Surface, away: Field, *, inner: float, outer: float) -> None:
    """Turn one zone: all within `outer` is raised or lowered, over a chamfer; only the zone has grooves."""
    chamfer = min(log_uniform(rng, (0.02, 0.8)), outer)
    within = 1 - smooth_step(away, outer - chamfer, outer)
    if rng.random() < 0.7:
        surface.height_mm += within * np.float32(uniform(rng, (-1, 1)) * log_uniform(rng, (0.01, 0.4)))
    zone = within * smooth_step(away, inner - surface.cell_mm, inner + surface.cell_mm)
    if rng.random() < 0.5:
        pitch = log_uniform(rng, (0.08, 0.8))
        slope = log_uniform(rng, (0.01, 0.4))
        wave = np.cos(2 * np.pi * away / np.float32(pitch))
        surface.height_mm += np.asarray(
            zone * np.float32(slope * pitch / (2 * np.pi)) * np.sign(wave) * np.sqrt(np.abs(wave)), np.float32
        )
    if rng.random() < 0.6:
        surface.blend(
            np.asarray(zone * np.float32(uniform(rng, (0.3, 1))), np.float32),
            reflectance=uniform(rng, (0.15, 1.0)),
            roughness=log_uniform(rng, (0.07, 0.45)),
        )

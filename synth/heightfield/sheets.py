"""The sheets of one part: disc inside and plate outside, each with its finish, and the joint between them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from synth.heightfield.grid import Field, Grid, noise, smooth_step
from synth.heightfield.sheet import FINISHES
from synth.heightfield.surface import Place, Surface
from synth.part.ranges import log_uniform, uniform


@dataclass(frozen=True, slots=True)
class Joint:
    """The joint between disc and plate: a circle round (x, y), mm."""

    x_mm: float
    y_mm: float
    radius_mm: float
    gap_mm: float
    step_mm: float
    """How much higher the disc lies than the plate."""


def make_sheets(
    rng: np.random.Generator, grid: Grid, joint: Joint, finishes: Sequence[str], *, is_joined: bool
) -> tuple[Surface, tuple[str, str]]:
    """Return the bare part, and the names of the finishes of plate and disc, drawn from `finishes`.

    Without a joint there is one plate, and no disc in it.
    """
    x, y = grid.coordinates()
    plate_finish = str(rng.choice(list(finishes)))
    disc_finish = plate_finish if not is_joined or rng.random() < 0.4 else str(rng.choice(list(finishes)))
    away = np.hypot(x - np.float32(joint.x_mm), y - np.float32(joint.y_mm)) - np.float32(joint.radius_mm)
    plate = FINISHES[plate_finish](rng, x, y, grid.cell_mm)
    same = not is_joined or (disc_finish == plate_finish and rng.random() < 0.5)
    disc = plate if same else FINISHES[disc_finish](rng, x, y, grid.cell_mm)
    inside = 1 - smooth_step(away, -0.5 * grid.cell_mm, 0.5 * grid.cell_mm)
    level = plate + inside * (disc + np.float32(joint.step_mm) - plate) if is_joined else plate
    surface = Surface(
        x_mm=x,
        y_mm=y,
        cell_mm=grid.cell_mm,
        height_mm=np.asarray(level, np.float32),
        reflectance=np.full_like(x, uniform(rng, (0.25, 1.0))),
        roughness=np.full_like(x, log_uniform(rng, (0.07, 0.42))),
        place=np.zeros(x.shape, np.uint8),
    )
    if not same:
        surface.blend(inside, reflectance=uniform(rng, (0.25, 1.0)), roughness=log_uniform(rng, (0.07, 0.42)))
    stains = noise(rng, x, y, (log_uniform(rng, (0.5, 6)), log_uniform(rng, (0.5, 6))))
    surface.reflectance *= np.exp(np.float32(uniform(rng, (0, 0.12))) * stains)
    if is_joined:
        _groove(rng, surface, joint, away)
    return surface, (plate_finish, disc_finish)


def _groove(rng: np.random.Generator, surface: Surface, joint: Joint, away: Field) -> None:
    """Cut the joint: a gap with rounded edges, dark where it is deep."""
    half = joint.gap_mm / 2
    edge = log_uniform(rng, (0.01, 0.12))
    depth = log_uniform(rng, (0.02, 0.4))
    grain = log_uniform(rng, (0.4, 3))
    wander = np.float32(log_uniform(rng, (0.003, 0.07))) * noise(
        rng, surface.x_mm, surface.y_mm, (grain, grain)
    )
    inside = 1 - smooth_step(np.abs(away + wander), half, half + edge)
    surface.height_mm -= np.float32(depth) * inside
    if joint.gap_mm > 0.01:
        open_gap = 1 - smooth_step(
            np.abs(away + wander), half - surface.cell_mm / 2, half + surface.cell_mm / 2
        )
        surface.blend(open_gap * np.float32(uniform(rng, (0.2, 1))), reflectance=uniform(rng, (0.01, 0.3)))
    surface.place[np.abs(away) < max(half, 0.12)] = Place.BARE_JOINT

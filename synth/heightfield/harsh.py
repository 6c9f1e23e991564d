"""What makes a weld hard to find: soot over its borders, bands of heat tint beside it, sharpened pictures."""

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.heightfield.grid import Field, noise, smooth_step
from synth.heightfield.sheets import Joint
from synth.heightfield.surface import Surface
from synth.part.ranges import log_uniform, uniform


def add_harsh_dirt(rng: np.random.Generator, surface: Surface, joint: Joint, half_width_mm: float) -> None:
    """Add clouds of soot with hard edges along the weld, and bands of heat tint beside it."""
    dx, dy = surface.x_mm - np.float32(joint.x_mm), surface.y_mm - np.float32(joint.y_mm)
    away = np.hypot(dx, dy) - np.float32(joint.radius_mm)
    if rng.random() < 0.6:
        _soot(rng, surface, away, half_width_mm)
    if rng.random() < 0.6:
        _bands(rng, surface, away, half_width_mm)


def _soot(rng: np.random.Generator, surface: Surface, away: Field, half_width_mm: float) -> None:
    x, y = surface.x_mm, surface.y_mm
    wide, fine = log_uniform(rng, (0.5, 4)), log_uniform(rng, (0.08, 0.5))
    cloud = noise(rng, x, y, (wide, wide)) + uniform(rng, (0.2, 0.9)) * noise(rng, x, y, (fine, fine))
    middle = uniform(rng, (-1.2, 1.2)) * half_width_mm
    reach = log_uniform(rng, (0.2, 0.8))
    near = np.exp(-(((away - np.float32(middle)) / np.float32(reach)) ** 2))
    low = uniform(rng, (-0.2, 1.2))
    thick = smooth_step(cloud + 1.5 * near, low + 0.8, low + 0.8 + log_uniform(rng, (0.1, 1.2))) * near
    surface.blend(
        np.asarray(np.clip(thick, 0, 1) * np.float32(uniform(rng, (0.4, 0.97))), np.float32),
        reflectance=uniform(rng, (0.0, 0.2)),
        roughness=0.45,
    )


def _bands(rng: np.random.Generator, surface: Surface, away: Field, half_width_mm: float) -> None:
    """Add dark and bright bands that follow the weld at a wandering distance, on one side or both."""
    x, y = surface.x_mm, surface.y_mm
    grain = log_uniform(rng, (0.5, 4))
    wander = np.float32(uniform(rng, (0.05, 0.4))) * noise(rng, x, y, (grain, grain))
    strength = np.clip(0.7 + 0.6 * noise(rng, x, y, (4.0, 4.0)), 0, 1.2)
    for side in (-1, 1):
        if rng.random() < 0.25:
            continue
        beside = np.float32(side) * away - np.float32(0.95 * half_width_mm)
        reach = log_uniform(rng, (0.2, 1.3))
        part = np.asarray((beside + wander) / np.float32(reach), np.float32)
        tinted = smooth_step(part, -0.3, 0.1) * (
            1 - smooth_step(part, 0.85, 0.85 + log_uniform(rng, (0.05, 0.6)))
        )
        tinted = np.asarray(tinted * (beside > 0), np.float32)
        waves = 0.5 + 0.5 * np.cos(np.pi * part * np.float32(uniform(rng, (1, 6))) + uniform(rng, (0, 6)))
        amount = np.float32(uniform(rng, (0.2, 0.9)))
        surface.reflectance *= np.asarray(1 - amount * np.clip(tinted * strength, 0, 1) * waves, np.float32)


def steepened(rng: np.random.Generator) -> float:
    """Return the factor of the bead's relief: real beads can be several times as steep as rendered ones."""
    return log_uniform(rng, (1.0, 3.0))


def softened(rng: np.random.Generator, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the picture as a lens out of focus gives it."""
    return np.asarray(cv2.GaussianBlur(image, (0, 0), log_uniform(rng, (0.5, 2.2))), np.uint8)


def harsh_picture(rng: np.random.Generator, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return the picture as many cameras and people make it: sharpened, or stretched in contrast."""
    seen = image
    if rng.random() < 0.5:
        soft = cv2.GaussianBlur(seen, (0, 0), log_uniform(rng, (0.7, 2.5)))
        amount = uniform(rng, (0.3, 2.0))
        seen = np.asarray(cv2.addWeighted(seen, 1 + amount, soft, -amount, 0), np.uint8)
    if rng.random() < 0.5:
        tiles = int(rng.integers(2, 9))
        seen = np.asarray(cv2.createCLAHE(uniform(rng, (1.5, 5)), (tiles, tiles)).apply(seen), np.uint8)
    return seen

"""From slopes to grey levels: a microfacet surface under lights, from a table over the surface's normal.

The camera looks straight down. For each roughness the light that a facet sends to the camera is summed over
all lights once, for all normals; a picture then only looks its normals up. GGX distribution, Smith masking:
Walter et al., "Microfacet models for refraction through rough surfaces", EGSR 2007.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.heightfield.grid import Field
from synth.part.ranges import log_uniform, uniform

Array = NDArray[np.float64]

TABLE = 129
"""Side of the table over the normal's x and y, -1 to 1."""
ROUGHNESSES = (0.06, 0.12, 0.24, 0.48)
"""Roughness of each table; values between are interpolated."""
HEIGHT_MM = 150.0
"""Height of the lights: towards them the normals turn across the part."""


@dataclass(frozen=True, slots=True, eq=False)
class Light:
    """Directions towards the lights (L, 3), unit vectors, with their strengths (L,), and diffuse light."""

    directions: Array
    strength: Array
    ambient: float


def draw_light(rng: np.random.Generator) -> Light:
    """Draw a light: a coaxial ring, a low ring, a dome, bars, or one side; often two of them."""
    directions, strength = [], []
    kinds = ["coaxial", "low", "dome", "bars", "side"]
    chosen = rng.choice(kinds, size=int(rng.integers(1, 3)), replace=False, p=[0.45, 0.18, 0.17, 0.1, 0.1])
    for kind in chosen:
        own = _directions(rng, str(kind))
        weight = np.full(len(own), log_uniform(rng, (0.3, 1.0)) / len(own))
        lean = uniform(rng, (0, 0.8)) * (rng.random() < 0.6)
        heading = uniform(rng, (0, 2 * np.pi))
        side = own[:, 0] * np.cos(heading) + own[:, 1] * np.sin(heading)
        weight *= 1 + lean * side / max(float(np.abs(side).max()), 1e-9)
        directions.append(own)
        strength.append(weight)
    return Light(np.concatenate(directions), np.concatenate(strength), log_uniform(rng, (0.005, 0.15)))


def with_side_light(rng: np.random.Generator, light: Light) -> Light:
    """Return the light with another one from the side, up to three times as strong."""
    own = _directions(rng, "side")
    weight = float(light.strength.sum()) * log_uniform(rng, (0.3, 3.0)) / len(own)
    return Light(
        np.concatenate([light.directions, own]),
        np.concatenate([light.strength, np.full(len(own), weight)]),
        light.ambient,
    )


def _directions(rng: np.random.Generator, kind: str) -> Array:
    if kind == "coaxial":
        spread = uniform(rng, (0.7, 1.5))
        slopes = [(17 * spread / HEIGHT_MM, 11), (33 * spread / HEIGHT_MM, 22)]
    elif kind == "low":
        slopes = [(uniform(rng, (0.6, 2.0)), 24)]
    elif kind == "dome":
        slopes = [(slope, 8 + 10 * i) for i, slope in enumerate((0.1, 0.3, 0.6, 1.0, 1.7))]
    elif kind == "side":
        angle, slope = uniform(rng, (0, 2 * np.pi)), uniform(rng, (0.15, 1.2))
        around = rng.normal(size=(12, 2)) * 0.08
        return _unit(slope * np.cos(angle) + around[:, 0], slope * np.sin(angle) + around[:, 1])
    else:
        angle, slope = uniform(rng, (0, np.pi)), uniform(rng, (0.15, 1.2))
        along = np.linspace(-0.5, 0.5, 12)
        x = np.concatenate([np.full(12, slope), np.full(12, -slope)])
        y = np.concatenate([along, along])
        return _unit(x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle))
    rows = []
    for slope, count in slopes:
        turn = (np.arange(count) + rng.random()) * 2 * np.pi / count
        rows.append(slope * np.stack([np.cos(turn), np.sin(turn)]))
    return _unit(*np.concatenate(rows, axis=1))


def _unit(x: Array, y: Array) -> Array:
    vectors = np.stack([x, y, np.ones_like(x)], axis=1)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def table(light: Light, roughness: float) -> Field:
    """Return the light that facets send up, (TABLE, TABLE): row = normal's y, column = its x, -1 to 1."""
    line = np.linspace(-1, 1, TABLE, dtype=np.float32)
    nx, ny = (axis[..., None] for axis in np.meshgrid(line, line))
    nz = np.sqrt(np.maximum(1 - nx * nx - ny * ny, np.float32(1e-4)))
    lights = light.directions.astype(np.float32)
    half = lights + np.array([0, 0, 1], np.float32)
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    a2 = np.float32(roughness**2)
    nh = np.maximum(nx * half[:, 0] + ny * half[:, 1] + nz * half[:, 2], 0)
    nl = np.maximum(nx * lights[:, 0] + ny * lights[:, 1] + nz * lights[:, 2], 0)
    spread = a2 / (np.pi * (nh * nh * (a2 - 1) + 1) ** 2)
    sent = spread * _smith(nl, a2) * _smith(nz, a2) / (4 * nz)
    return np.asarray(sent @ light.strength.astype(np.float32) + np.float32(light.ambient), np.float32)


def _smith(cosine: Field, a2: np.float32) -> Field:
    """Return the fraction of facets that stand free towards a direction with this cosine; 0 behind."""
    return np.asarray(2 * cosine / (cosine + np.sqrt(a2 + (1 - a2) * cosine * cosine) + np.float32(1e-9)))


def shade(height_mm: Field, roughness: Field, light: Light, x_mm: Field, y_mm: Field) -> Field:
    """Return the radiance (H, W) of a height field, as if it reflected all light; cells are square."""
    cell = float(x_mm[0, 1] - x_mm[0, 0])
    slope_x = cv2.Scharr(height_mm, cv2.CV_32F, 1, 0, scale=1 / (32 * cell))
    slope_y = cv2.Scharr(height_mm, cv2.CV_32F, 0, 1, scale=1 / (32 * cell))
    length = np.sqrt(1 + slope_x * slope_x + slope_y * slope_y)
    shift = np.float32(1 / (2 * HEIGHT_MM))
    scale = np.float32((TABLE - 1) / 2)
    at_x = np.clip((-slope_x / length + x_mm * shift + 1) * scale, 0, TABLE - 1)
    at_y = np.clip((-slope_y / length + y_mm * shift + 1) * scale, 0, TABLE - 1)
    level = np.interp(np.log(roughness), np.log(ROUGHNESSES), np.arange(len(ROUGHNESSES))).astype(np.float32)
    radiance = np.zeros_like(height_mm)
    for index, value in enumerate(ROUGHNESSES):
        weight = np.clip(1 - np.abs(level - index), 0, 1)
        if float(weight.max()) > 0:
            radiance += weight * cv2.remap(table(light, value), at_x, at_y, cv2.INTER_LINEAR)
    return radiance


def shadow(height_mm: Field, cell_mm: float, depth: float) -> Field:
    """Return how much light reaches each place, 0 to 1: less where the surroundings stand higher."""
    seen = np.ones_like(height_mm)
    for reach_mm in (0.06, 0.2, 0.6):
        sigma = max(reach_mm / cell_mm, 0.8)
        above = np.maximum(cv2.GaussianBlur(height_mm, (0, 0), sigma) - height_mm, 0.0)
        seen *= np.exp(-np.float32(depth) * above / np.float32(reach_mm))
    return seen

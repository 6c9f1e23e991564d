"""The ring light as data: 33 Gaussian spots, or a Lambertian area emitter of the same shape (paper, section 4.2).

World: x right, y up, z to the camera, mm. The camera looks through the light's through-hole.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part
from synth.part.switches import Switch

Array = NDArray[np.float64]

HEIGHT_MM = 150.0
"""Of the light above the part."""
SPOT_RINGS_MM = ((17.0, 11), (33.0, 22))
"""Radius and number of spots of each ring: 33 in all."""
DISC_MM = (10.0, 40.0)
"""Inner (through-hole) and outer radius of the emitting area."""
OPENING_DEG = 35.0
"""Full width at half maximum of a spot's Gaussian in angle."""
INTENSITY = 2.0e5
"""Sum of all spots' intensities on their axes; the area emitter has the same."""
SECOND_RING_MM = (62.0, 70.0, 24)
"""Radius, height and number of spots of the second light, a low ring that also lights flanks."""


@dataclass(frozen=True, slots=True)
class Lights:
    """Emitters that all look straight down.

    positions_mm (L, 3), intensity (L,): on the axis; sigma_rad (L,): standard deviation of the Gaussian in angle.
    A Lambertian area emitter is its disc finely divided, with `lambertian` set: intensity falls with the cosine.
    """

    positions_mm: Array
    intensity: Array
    sigma_rad: Array
    lambertian: bool


def lights(part: Part, switches: frozenset[Switch]) -> Lights:
    """Lights of a part's scene; `part.light_scale`, `light_lean` and `second_light` vary them."""
    if Switch.MODELLED_ILLUMINATION in switches:
        spots = _rings(SPOT_RINGS_MM)
        sigma = np.full(len(spots), np.deg2rad(OPENING_DEG) / 2.3548)
    else:
        spots = _disc(*DISC_MM)
        sigma = np.zeros(len(spots))
    spots[:, :2] *= part.light_scale
    heading = np.deg2rad(part.light_heading_deg)
    side = (spots[:, 0] * np.cos(heading) - spots[:, 1] * np.sin(heading)) / np.abs(spots[:, :2]).max()
    intensity = INTENSITY / len(spots) * (1.0 + part.light_lean * side)
    if part.second_light > 0 and Switch.MODELLED_ILLUMINATION in switches:
        radius_mm, height_mm, count = SECOND_RING_MM
        low = _rings(((radius_mm, count),), height_mm)
        spots = np.concatenate([spots, low])
        sigma = np.concatenate([sigma, np.full(count, np.deg2rad(60.0))])
        intensity = np.concatenate([intensity, np.full(count, part.second_light * INTENSITY / count)])
    return Lights(spots, intensity, sigma, Switch.MODELLED_ILLUMINATION not in switches)


def _rings(rings: tuple[tuple[float, int], ...], height_mm: float = HEIGHT_MM) -> Array:
    rows = []
    for radius, count in rings:
        angle = (np.arange(count) + 0.5) * 2 * np.pi / count
        rows.append(np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height_mm)], axis=1))
    return np.concatenate(rows)


def _disc(inner_mm: float, outer_mm: float, count: int = 66) -> Array:
    """Points that cover an annulus evenly (sunflower spiral)."""
    k = np.arange(count) + 0.5
    radius = np.sqrt(inner_mm**2 + (outer_mm**2 - inner_mm**2) * k / count)
    angle = k * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, HEIGHT_MM)], axis=1)

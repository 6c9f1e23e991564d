"""The ring light as data: 33 Gaussian spots, or an area emitter of the same shape (paper, section 4.2).

World: x right, y up, z to the camera, mm. The camera looks through the light's through-hole.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.part.light import Light
from synth.part.switches import Switch

Array = NDArray[np.float64]

HEIGHT_MM = 150.0
"""Height of the light above the part."""
SPOT_RINGS_MM = ((17.0, 11), (33.0, 22))
"""Radius and number of spots of each ring: 33 in all."""
DISC_MM = (10.0, 40.0)
"""Inner (through-hole) and outer radius of the emitting area."""
DISC_POINTS = 66
"""Points that the emitting area is divided into."""
OPENING_DEG = 35.0
"""Full width at half maximum of a spot's Gaussian in angle."""
INTENSITY = 2.0e5
"""Sum of all spots' intensities on their axes; the area emitter has the same."""
SECOND_RING_MM = (62.0, 70.0, 24)
"""Radius, height and number of spots of the second light, a low ring that also lights flanks."""
SECOND_SIGMA_DEG = 60.0
"""Standard deviation of the Gaussian in angle of a spot of the second light."""


@dataclass(frozen=True, slots=True)
class Lights:
    """Emitters that all look straight down.

    positions_mm (L, 3), intensity (L,): on the axis; sigma_rad (L,): standard deviation of the Gaussian in
    angle. A Lambertian area emitter is its disc finely divided, with `lambertian` set: intensity falls with
    the cosine.
    """

    positions_mm: Array
    intensity: Array
    sigma_rad: Array
    lambertian: bool


def lights(light: Light, switches: frozenset[Switch]) -> Lights:
    """Return the emitters of a drawn light."""
    is_modelled = Switch.MODELLED_ILLUMINATION in switches
    spots = _rings(SPOT_RINGS_MM, HEIGHT_MM) if is_modelled else _disc(*DISC_MM, DISC_POINTS)
    sigma = np.full(len(spots), np.deg2rad(OPENING_DEG) / 2.3548 if is_modelled else 0.0)
    spots[:, :2] *= light.scale
    heading = np.deg2rad(light.heading_deg)
    side = (spots[:, 0] * np.cos(heading) - spots[:, 1] * np.sin(heading)) / np.abs(spots[:, :2]).max()
    intensity = INTENSITY / len(spots) * (1.0 + light.lean * side)
    if light.second > 0 and is_modelled:
        radius_mm, height_mm, count = SECOND_RING_MM
        spots = np.concatenate([spots, _rings(((radius_mm, count),), height_mm)])
        sigma = np.concatenate([sigma, np.full(count, np.deg2rad(SECOND_SIGMA_DEG))])
        intensity = np.concatenate([intensity, np.full(count, light.second * INTENSITY / count)])
    return Lights(spots, intensity, sigma, lambertian=not is_modelled)


def _rings(rings: tuple[tuple[float, int], ...], height_mm: float) -> Array:
    rows = []
    for radius, count in rings:
        angle = (np.arange(count) + 0.5) * 2 * np.pi / count
        rows.append(
            np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, height_mm)], axis=1)
        )
    return np.concatenate(rows)


def _disc(inner_mm: float, outer_mm: float, count: int) -> Array:
    """Return points that cover an annulus evenly (sunflower spiral)."""
    k = np.arange(count) + 0.5
    radius = np.sqrt(inner_mm**2 + (outer_mm**2 - inner_mm**2) * k / count)
    angle = k * np.pi * (3.0 - np.sqrt(5.0))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), np.full(count, HEIGHT_MM)], axis=1)

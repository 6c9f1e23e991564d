"""Surfaces of weld beads: families that share no code for their ripples.

A family is a function of weld coordinates: `s_mm` along the weld, `across` it from -1 (inner border) to 1.
"""

from collections.abc import Callable

import numpy as np

from synth.heightfield.grid import Field, noise
from synth.part.ranges import log_uniform, uniform

Family = Callable[[np.random.Generator, Field, Field, float], Field]
"""Function of generator, place along the weld (mm), place across it (-1 to 1) and half the width (mm).

It returns the height in mm.
"""


def crescents(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return solidification ripples: crescents or arrows of wandering pitch."""
    pitch = log_uniform(rng, (0.09, 0.6))
    ahead = uniform(rng, (0.1, 0.8)) * half_mm * 2
    power = uniform(rng, (1.0, 2.6))
    front = np.float32(ahead) * (1 - np.abs(across) ** np.float32(power))
    warp = pitch * (0.5 * noise(rng, s_mm, across, (0.8, 0.9)) + 0.12 * noise(rng, s_mm, across, (0.15, 0.3)))
    phase = 2 * np.pi * (s_mm - front + warp) / np.float32(pitch)
    sharp = uniform(rng, (0.0, 0.5))
    wave = np.sin(phase) + np.float32(sharp) * np.sin(2 * phase + 0.8)
    strength = np.clip(1 + uniform(rng, (0.2, 0.9)) * noise(rng, s_mm, across, (1.0, 0.8)), 0.0, 2.5)
    return np.asarray(log_uniform(rng, (0.02, 0.4)) * pitch / (2 * np.pi) * wave * strength, np.float32)


def sparse(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return a calm bead with a few deep ripples, alone or in groups."""
    ripples = crescents(rng, s_mm, across, half_mm)
    groups = noise(rng, s_mm, across, (log_uniform(rng, (0.15, 1.5)), uniform(rng, (0.3, 1.2))))
    low = uniform(rng, (0.4, 1.8))
    few = 1 / (1 + np.exp(-(groups - low) / np.float32(uniform(rng, (0.1, 0.4)))))
    return np.asarray(
        ripples * (few + uniform(rng, (0, 0.15))) + worn(rng, s_mm, across, half_mm), np.float32
    )


def pulsed(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return overlapping round spots of a pulsed laser: each later one lies over the one before."""
    pitch = half_mm * log_uniform(rng, (0.18, 1.1))
    across_mm = np.clip(across, -1, 1) * np.float32(half_mm)
    wander = np.float32(0.08 * pitch) * noise(rng, s_mm, across, (1.5, 2.0))
    reach = np.sqrt(np.maximum(np.float32(half_mm**2 * 1.02) - across_mm**2, 0.0))
    number = np.floor((s_mm + wander + reach) / np.float32(pitch))
    u_mm = s_mm + wander - number * np.float32(pitch)
    rho = np.hypot(u_mm, across_mm) / np.float32(half_mm)
    own = np.sin(number * np.float32(12.9898)) * 43758.5453
    own = own - np.floor(own)  # a random number of each spot
    dish = uniform(rng, (-0.06, 0.06)) * half_mm * rho**2
    rings = log_uniform(rng, (0.001, 0.012)) * np.cos(2 * np.pi * rho * np.float32(uniform(rng, (2, 6))))
    rim = uniform(rng, (0.0, 0.03)) * half_mm * np.exp(-(((rho - 0.93) / 0.08) ** 2))
    return np.asarray((dish + rings + rim) * (0.6 + 0.8 * own), np.float32)


def wobbled(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return the crossing arcs of a beam that circles while it advances."""
    pitch = log_uniform(rng, (0.08, 0.5))
    arc = np.float32(half_mm) * np.sqrt(np.maximum(1 - (np.clip(across, -1, 1) * np.float32(0.97)) ** 2, 0.0))
    wander = np.float32(0.2 * pitch) * noise(rng, s_mm, across, (2.0, 2.0))
    forward = np.cos(2 * np.pi * (s_mm + wander - arc) / np.float32(pitch))
    back = np.cos(2 * np.pi * (s_mm + wander + arc) / np.float32(pitch))
    mix = uniform(rng, (0.2, 1.0))
    lanes = uniform(rng, (0.0, 0.8)) * np.cos(np.pi * across * np.float32(uniform(rng, (1, 4))))
    strength = np.clip(1 + 0.4 * noise(rng, s_mm, across, (1.0, 1.0)), 0.1, 2.0)
    return np.asarray(
        log_uniform(rng, (0.02, 0.3))
        * pitch
        / (2 * np.pi)
        * (np.maximum(forward, mix * back) + lanes)
        * strength,
        np.float32,
    )


def flowing(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return the smooth skin of a long melt pool, with tails that trail away from its middle."""
    trail = s_mm - np.float32(uniform(rng, (0.5, 3.0)) * half_mm) * np.abs(across).astype(np.float32)
    tails = noise(rng, trail, across, (log_uniform(rng, (0.3, 2.0)), uniform(rng, (0.15, 0.5))))
    long = noise(rng, s_mm, across, (log_uniform(rng, (1.0, 5.0)), 1.5))
    return np.asarray(
        log_uniform(rng, (0.0008, 0.008)) * tails + log_uniform(rng, (0.001, 0.015)) * long, np.float32
    )


def humped(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return a bead that gathers into humps, with a grain on them."""
    pitch = log_uniform(rng, (0.5, 2.5))
    warp = np.float32(0.35 * pitch) * noise(rng, s_mm, across, (2 * pitch, 2.0))
    phase = 2 * np.pi * (s_mm + warp - np.float32(0.3 * half_mm) * (1 - across * across)) / np.float32(pitch)
    hump = np.float32(log_uniform(rng, (0.01, 0.09))) * (np.sin(phase) + 0.3 * np.sin(2 * phase + 1.0))
    grain = log_uniform(rng, (0.001, 0.008)) * noise(rng, s_mm, across * np.float32(half_mm), (0.12, 0.12))
    return np.asarray(hump * (1 - 0.7 * np.minimum(np.abs(across), 1) ** 2) + grain, np.float32)


def scaly(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return a skin of scales, as of oxide: flakes with edges, of random size and height."""
    across_mm = across * np.float32(half_mm)
    height = np.zeros_like(s_mm)
    for grain in (log_uniform(rng, (0.15, 0.6)), log_uniform(rng, (0.06, 0.2))):
        first = noise(rng, s_mm, across_mm, (grain * uniform(rng, (0.7, 2.5)), grain))
        second = noise(rng, s_mm, across_mm, (grain * uniform(rng, (0.7, 2.5)), grain))
        height += grain * np.maximum(first, second)
    return np.asarray(log_uniform(rng, (0.03, 0.25)) * height, np.float32)


def worn(rng: np.random.Generator, s_mm: Field, across: Field, half_mm: float) -> Field:
    """Return a bead with hardly any relief of its own: remelted, or polished by a second pass."""
    grain = log_uniform(rng, (0.08, 0.5))
    return np.asarray(
        log_uniform(rng, (0.0003, 0.003)) * noise(rng, s_mm, across * np.float32(half_mm), (grain, grain))
    )


FAMILIES: dict[str, Family] = {
    "crescents": crescents,
    "sparse": sparse,
    "pulsed": pulsed,
    "wobbled": wobbled,
    "flowing": flowing,
    "humped": humped,
    "scaly": scaly,
    "worn": worn,
}
"""Families of weld surfaces by name."""

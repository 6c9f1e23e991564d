"""Relief and contour of one weld on a polar grid, numpy only.

Grid: `theta_rad` (M,) clockwise as seen in the image, periodic; `t` (N,) from -1 (inner border) to +1 (outer border).
Fields are (M, N) float64. Lengths in mm.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from synth.part import Part

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Contour:
    """Centre line, borders and joint of a weld over the angle; arrays of shape (M,), mm."""

    center_mm: Array
    inner_mm: Array
    """Radius of the bead's inner border; equals `joint_inner_mm` where the weld is missing."""
    outer_mm: Array
    joint_inner_mm: Array
    joint_outer_mm: Array
    present: NDArray[np.bool_]
    """Where there is a bead."""


def harmonics(rng: np.random.Generator, theta_rad: Array, low: int, high: int) -> Array:
    """Sum of sine waves of normal amplitude and random phase (paper, eq. 4), scaled to standard deviation 1.

    Harmonics start at `low`: from 2 on, the best circle through the curve stays where it is.
    """
    k = np.arange(low, high + 1)[:, None]
    amplitude = rng.normal(size=k.shape) / np.sqrt(k)
    phase = rng.uniform(0, 2 * np.pi, size=k.shape)
    wave = (amplitude * np.sin(k * theta_rad + phase)).sum(axis=0)
    return np.asarray(wave / max(float(wave.std()), 1e-9))


def noise(rng: np.random.Generator, shape: tuple[int, int], cells: tuple[float, float]) -> Array:
    """Band-limited Gaussian noise, periodic along both axes, standard deviation 1; `cells` is its grain in grid cells."""
    f0 = np.fft.fftfreq(shape[0])[:, None] * cells[0]
    f1 = np.fft.rfftfreq(shape[1])[None, :] * cells[1]
    spectrum = np.fft.rfft2(rng.normal(size=shape)) * np.exp(-2.0 * (f0**2 + f1**2))
    field = np.fft.irfft2(spectrum, s=shape)
    return np.asarray(field / max(float(field.std()), 1e-9))


def contour(part: Part, theta_rad: Array) -> Contour:
    """Borders of the bead with its random contour, and of the joint below it."""
    rng = np.random.default_rng([part.seed, 2])
    center_mm = part.radius_mm + part.wobble_mm * 0.6 * harmonics(rng, theta_rad, 2, 9)
    rough = [part.wobble_mm * (0.5 * harmonics(rng, theta_rad, 2, 30) + 0.4 * harmonics(rng, theta_rad, 40, 400)) for _ in range(2)]
    joint_mm = part.radius_mm + 0.012 * harmonics(rng, theta_rad, 2, 40)
    gap_mm = part.gap_mm * (1.0 + 0.15 * harmonics(rng, theta_rad, 2, 60).clip(-2, 2))
    cap = _caps(part, theta_rad)
    present = cap > 0
    half_mm = part.half_width_mm
    joint_inner_mm, joint_outer_mm = joint_mm - gap_mm / 2, joint_mm + gap_mm / 2
    inner_mm = np.where(present, np.minimum(center_mm - (half_mm + rough[0]) * cap, joint_inner_mm), joint_inner_mm)
    outer_mm = np.where(present, np.maximum(center_mm + (half_mm + rough[1]) * cap, joint_outer_mm), joint_outer_mm)
    return Contour(center_mm, inner_mm, outer_mm, joint_inner_mm, joint_outer_mm, present)


def _caps(part: Part, theta_rad: Array) -> Array:
    """Width factor 0 to 1: rounded ends at each missing arc."""
    factor = np.ones_like(theta_rad)
    for arc in part.missing:
        if arc.end_deg - arc.start_deg >= 360:
            return np.zeros_like(theta_rad)
        middle = np.deg2rad((arc.start_deg + arc.end_deg) / 2)
        half = np.deg2rad((arc.end_deg - arc.start_deg) / 2)
        away_rad = np.abs((theta_rad - middle + np.pi) % (2 * np.pi) - np.pi) - half
        e = np.clip(away_rad * part.radius_mm / (0.7 * part.half_width_mm), 0.0, 1.0)
        factor = np.minimum(factor, np.sqrt(1.0 - (1.0 - e) ** 2))
    return factor


def relief(part: Part, theta_rad: Array, t: Array) -> Array:
    """Height of the bead above the partners, (M, N), mm: crown, ripples, irregular relief and end crater."""
    rng = np.random.default_rng([part.seed, 3])
    shape = (theta_rad.size, t.size)
    cell_mm = (2 * np.pi * part.radius_mm / shape[0], 2 * part.half_width_mm / shape[1])
    length_mm = 2 * np.pi * part.radius_mm

    e = (part.direction * (theta_rad - np.deg2rad(part.start_deg)) + np.pi) % (2 * np.pi) - np.pi
    e_mm = (e * part.radius_mm)[:, None]
    across_mm = t[None, :] * part.half_width_mm
    to_end_mm = np.hypot(e_mm, across_mm)
    in_pool = (to_end_mm < part.half_width_mm * 0.95) & (e_mm > 0)
    at_end = (e_mm < 0) | in_pool
    s_mm = np.where(at_end, e_mm + length_mm, e_mm)

    arrow = 1.0 - np.abs(t[None, :])
    ahead_mm = part.crescent_mm * ((1.0 - part.chevron) * np.exp(-0.5 * (t[None, :] / 0.55) ** 2) + part.chevron * arrow)
    warp_mm = part.ripple_pitch_mm * (
        0.55 * noise(rng, shape, (0.8 / cell_mm[0], 0.5 / cell_mm[1])) + 0.10 * noise(rng, shape, (0.15 / cell_mm[0], 0.1 / cell_mm[1]))
    )
    phase = 2 * np.pi * (s_mm - ahead_mm + warp_mm) / part.ripple_pitch_mm
    strength = np.clip(1.0 + 0.45 * noise(rng, shape, (0.7 / cell_mm[0], 0.4 / cell_mm[1])), 0.1, 2.2)
    extra = np.random.default_rng([part.seed, 9])
    if part.sparsity > 0:
        few = noise(extra, shape, (1.6 * part.ripple_pitch_mm / cell_mm[0], 0.6 / cell_mm[1]))
        strength *= 1.0 - part.sparsity + part.sparsity * 2.5 / (1.0 + np.exp(-(few - 1.0) / 0.25))
    ripple = np.sin(phase) + 0.4 * np.sin(2 * phase + 0.9) + 0.15 * np.sin(3 * phase + 1.7)
    amplitude_mm = part.ripple_slope * part.ripple_pitch_mm / (2 * np.pi)
    z_mm = amplitude_mm * strength * ripple

    for grain_mm, share in ((0.16, 0.7), (0.05, 0.7)):
        field = noise(rng, shape, (grain_mm / cell_mm[0], grain_mm / cell_mm[1]))
        slope = np.sqrt(np.mean((np.diff(field, axis=0) / cell_mm[0]) ** 2))
        z_mm += share * part.rough_slope / slope * field

    z_mm *= np.exp(-0.5 * (np.abs(t[None, :]) / 0.8) ** 4)
    if part.undercut_mm > 0:
        along = np.clip(0.3 + noise(extra, shape, (0.8 / cell_mm[0], shape[1])), 0.0, 2.0)
        z_mm -= part.undercut_mm * along * np.exp(-0.5 * ((np.abs(t[None, :]) - 0.92) / 0.05) ** 2)
    z_mm += part.crown_mm * (1.0 - np.abs(t[None, :]) ** 2.5)

    lip = np.exp(-0.5 * ((to_end_mm - part.half_width_mm * 0.95) / 0.03) ** 2) * (e_mm > -0.1)
    bowl = np.exp(-0.5 * (to_end_mm / (0.45 * part.half_width_mm)) ** 2)
    depth = np.random.default_rng([part.seed, 4]).uniform(0.3, 1.2)
    return np.asarray(z_mm + depth * (0.015 * lip - 0.04 * bowl))

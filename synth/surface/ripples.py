"""Solidification ripples drawn directly: what a weld looks like beyond the one that was measured. numpy only."""

import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.surface.contour import from_start_mm
from synth.surface.noise import gaussian

Array = NDArray[np.float64]


def ripples(part: Part, theta_rad: Array, t: Array) -> Array:
    """Height (M, N) of the ripples, mm: crescents or arrows with wandering pitch and strength, gathered where sparse."""
    rng = stream(part.seed, Stream.RIPPLES)
    shape = (theta_rad.size, t.size)
    step_rad = theta_rad[1] - theta_rad[0]
    cell_mm = (float(step_rad) * part.radius_mm, 2 * part.half_width_mm / shape[1])
    length_mm = 2 * np.pi * part.radius_mm

    e_mm = from_start_mm(part, theta_rad)[:, None]
    to_end_mm = np.hypot(e_mm, t[None, :] * part.half_width_mm)
    in_pool = (to_end_mm < part.half_width_mm * 0.95) & (e_mm > 0)
    s_mm = np.where((e_mm < 0) | in_pool, e_mm + length_mm, e_mm)

    arrow = 1.0 - np.abs(t[None, :])
    ahead_mm = part.crescent_mm * ((1.0 - part.chevron) * np.exp(-0.5 * (t[None, :] / 0.55) ** 2) + part.chevron * arrow)
    warp_mm = 0.55 * part.ripple_pitch_mm * gaussian(rng, shape, (0.8 / cell_mm[0], 0.5 / cell_mm[1]))
    warp_mm += 0.10 * part.ripple_pitch_mm * gaussian(rng, shape, (0.15 / cell_mm[0], 0.1 / cell_mm[1]))
    phase = 2 * np.pi * (s_mm - ahead_mm + warp_mm) / part.ripple_pitch_mm
    strength = np.clip(1.0 + 0.45 * gaussian(rng, shape, (0.7 / cell_mm[0], 0.4 / cell_mm[1])), 0.1, 2.2)
    if part.sparsity > 0:
        few = gaussian(rng, shape, (1.6 * part.ripple_pitch_mm / cell_mm[0], 0.6 / cell_mm[1]))
        strength *= 1.0 - part.sparsity + part.sparsity * 2.5 / (1.0 + np.exp(-(few - 1.0) / 0.25))
    wave = np.sin(phase) + 0.4 * np.sin(2 * phase + 0.9) + 0.15 * np.sin(3 * phase + 1.7)
    return np.asarray(part.ripple_slope * part.ripple_pitch_mm / (2 * np.pi) * strength * wave)

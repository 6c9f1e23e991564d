"""Solidification ripples drawn directly: relief beyond that of the measured weld. numpy only."""

import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.surface.contour import from_end_mm
from synth.surface.noise import gaussian

Array = NDArray[np.float64]


def ripples(part: Part, theta_rad: Array, t: Array) -> Array:
    """Return the height (M, N) of the ripples, mm: crescents or arrows of wandering pitch and strength."""
    rng = stream(part.seed, Stream.RIPPLES)
    bead, relief = part.bead, part.relief
    shape = (theta_rad.size, t.size)
    step_rad = theta_rad[1] - theta_rad[0]
    cell_mm = (float(step_rad) * bead.radius_mm, 2 * bead.half_width_mm / shape[1])
    turn_mm = 2 * np.pi * bead.radius_mm

    end_mm = from_end_mm(part, theta_rad)[:, None]
    to_end_mm = np.hypot(end_mm, t[None, :] * bead.half_width_mm)
    in_pool = (to_end_mm < bead.half_width_mm * 0.95) & (end_mm > 0)
    along_mm = np.where((end_mm < 0) | in_pool, end_mm + turn_mm, end_mm)

    arrow = 1.0 - np.abs(t[None, :])
    crescent = np.exp(-0.5 * (t[None, :] / 0.55) ** 2)
    ahead_mm = relief.crescent_mm * ((1.0 - relief.chevron) * crescent + relief.chevron * arrow)
    warp_mm = 0.55 * relief.ripple_pitch_mm * gaussian(rng, shape, (0.8 / cell_mm[0], 0.5 / cell_mm[1]))
    warp_mm += 0.10 * relief.ripple_pitch_mm * gaussian(rng, shape, (0.15 / cell_mm[0], 0.1 / cell_mm[1]))
    phase = 2 * np.pi * (along_mm - ahead_mm + warp_mm) / relief.ripple_pitch_mm
    strength = np.clip(1.0 + 0.45 * gaussian(rng, shape, (0.7 / cell_mm[0], 0.4 / cell_mm[1])), 0.1, 2.2)
    if relief.sparsity > 0:
        few = gaussian(rng, shape, (1.6 * relief.ripple_pitch_mm / cell_mm[0], 0.6 / cell_mm[1]))
        strength *= 1.0 - relief.sparsity + relief.sparsity * 2.5 / (1.0 + np.exp(-(few - 1.0) / 0.25))
    wave = np.sin(phase) + 0.4 * np.sin(2 * phase + 0.9) + 0.15 * np.sin(3 * phase + 1.7)
    return np.asarray(relief.ripple_slope * relief.ripple_pitch_mm / (2 * np.pi) * strength * wave)

"""Relief of one weld on a polar grid: spectrum or ripples, edges, noise, craters (paper, 3.3 and 3.4.1).

Grid: `theta_rad` (M,) clockwise as seen in the image; `t` (N,) from -1 (inner border) to +1 (outer border).
Fields are (M, N) float64, mm.
"""

import numpy as np
from numpy.typing import NDArray

from synth.measured.spectrum import WeldModel, resample, synthesize
from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.part.switches import Switch
from synth.surface.contour import from_end_mm, overlap_weight
from synth.surface.noise import gaussian, perlin
from synth.surface.ripples import ripples

Array = NDArray[np.float64]

SPECTRUM_ROWS = 128
"""Rows across the weld of the map that eq. (2) is evaluated on."""


def relief(part: Part, theta_rad: Array, t: Array, model: WeldModel) -> Array:
    """Return the height of the bead above the partners, (M, N), mm."""
    z_mm = np.full((theta_rad.size, t.size), part.bead.crown_mm)
    if Switch.TOPOGRAPHY in part.switches:
        is_spectral = part.relief.is_spectral
        z_mm = z_mm + (spectral(part, theta_rad, t, model) if is_spectral else ripples(part, theta_rad, t))
    if Switch.PERLIN in part.switches:
        z_mm = z_mm + discontinuities(part, theta_rad, t)
    if Switch.REDUCED_EDGES in part.switches:
        z_mm = z_mm * edge_weight(part, t, model)[None, :]
    if Switch.TOPOGRAPHY in part.switches:
        z_mm = z_mm + _groove(part, theta_rad, t) + _ends(part, theta_rad, t)
    return z_mm


def spectral(part: Part, theta_rad: Array, t: Array, model: WeldModel) -> Array:
    """Return the surface of eq. (2), its rows shifted along the weld by the Gaussian of Fig. 4b: the scales.

    It closes round a ring without a seam.
    """
    rng = stream(part.seed, Stream.SPECTRUM)
    is_closed = part.geometry.is_closed
    length_mm = part.geometry.length_mm if is_closed else model.length_mm
    step_mm = float(theta_rad[1] - theta_rad[0]) * part.bead.radius_mm
    columns = theta_rad.size if is_closed else round(length_mm / step_mm)
    surface_um = synthesize(rng, resample(model, length_mm, (SPECTRUM_ROWS, columns)))
    across_mm = t * part.bead.half_width_mm
    rows = (across_mm / model.width_mm * SPECTRUM_ROWS).round().astype(int) % SPECTRUM_ROWS
    ahead_mm = model.shift(across_mm) * part.relief.shift_scale
    column = (
        np.arange(theta_rad.size)[:, None] - part.bead.direction * ahead_mm[None, :] / step_mm
    ) % columns
    low = np.floor(column).astype(int)
    above = column - low
    low %= columns
    high = (low + 1) % columns
    picked = surface_um[rows[None, :], low] * (1 - above) + surface_um[rows[None, :], high] * above
    return np.asarray(picked * part.relief.height_scale / 1000.0)


def edge_weight(part: Part, t: Array, model: WeldModel) -> Array:
    """Return the weight (N,) of the height: the measured Gaussian (Fig. 4c), or a flatter one for ripples."""
    if part.relief.is_spectral:
        y_mm = t * model.width_mm / 2
        sigma = min(model.edge.sigma_mm, 0.45 * model.width_mm)
        return np.asarray(np.exp(-0.5 * (y_mm / sigma) ** 2))
    return np.asarray(np.exp(-0.5 * (np.abs(t) / 0.8) ** 4) * 0.45 + 0.55 * (1.0 - np.abs(t) ** 2.5))


def discontinuities(part: Part, theta_rad: Array, t: Array) -> Array:
    """Return Perlin noise of two grains, each scaled to its fraction of the slope `rough_slope`."""
    rng = stream(part.seed, Stream.PERLIN)
    shape = (theta_rad.size, t.size)
    step_mm = float(theta_rad[1] - theta_rad[0]) * part.bead.radius_mm
    size_mm = (shape[0] * step_mm, 2 * part.bead.half_width_mm)
    total = np.zeros(shape)
    for grain_mm, fraction in ((0.16, 0.7), (0.05, 0.7)):
        nodes = (max(2, round(size_mm[0] / grain_mm)), max(2, round(size_mm[1] / grain_mm)))
        field = perlin(rng, shape, nodes)
        slope = float(np.sqrt(np.mean((np.diff(field, axis=0) / step_mm) ** 2)))
        total += fraction * part.relief.rough_slope / slope * field
    return total


def _groove(part: Part, theta_rad: Array, t: Array) -> Array:
    """Return the undercut: a groove of varying depth along both borders."""
    if part.bead.undercut_mm == 0:
        return np.zeros((theta_rad.size, t.size))
    rng = stream(part.seed, Stream.UNDERCUT)
    cell_mm = float(theta_rad[1] - theta_rad[0]) * part.bead.radius_mm
    along = np.clip(0.3 + gaussian(rng, (theta_rad.size, t.size), (0.8 / cell_mm, t.size)), 0.0, 2.0)
    return np.asarray(
        -part.bead.undercut_mm * along * np.exp(-0.5 * ((np.abs(t[None, :]) - 0.92) / 0.05) ** 2)
    )


def _ends(part: Part, theta_rad: Array, t: Array) -> Array:
    """Return the end crater with its lip, and the raised second pass with the button of the start."""
    bead = part.bead
    end_mm = from_end_mm(part, theta_rad)[:, None]
    across_mm = t[None, :] * bead.half_width_mm
    to_end_mm = np.hypot(end_mm, across_mm)
    lip = np.exp(-0.5 * ((to_end_mm - bead.half_width_mm * 0.95) / 0.03) ** 2) * (end_mm > -0.1)
    bowl = np.exp(-0.5 * (to_end_mm / (0.45 * bead.half_width_mm)) ** 2)
    raised = overlap_weight(part, theta_rad)[:, None] * (1 - t[None, :] ** 2) * bead.overlap_height_mm
    to_start_mm = np.hypot(end_mm + bead.overlap_mm, across_mm)
    button = bead.overlap_height_mm * np.exp(-0.5 * (to_start_mm / (0.5 * bead.half_width_mm)) ** 2)
    return np.asarray(bead.crater_mm * (0.375 * lip - bowl) + raised + button)

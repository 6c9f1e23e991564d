"""Surfaces as data: metals by name, and maps of reflectance and soot. numpy and OpenCV drawing only.

Stripes, scratches, dust, heat tint and the part's other circles change the metal's reflectance; soot is a
fraction of another BSDF.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.part.switches import Switch
from synth.surface.contour import bead_width
from synth.surface.noise import gaussian

Texture = NDArray[np.float32]

METALS = {
    "steel": (2.95, 2.93),
    "aluminium": (0.963, 6.70),
    "copper": (1.02, 2.577),
    "nickel-plated": (1.92, 3.61),
}
"""Complex refractive index eta + i k at 550 nm.

Iron (for steel) and nickel: Johnson and Christy, Phys. Rev. B 9, 5056 (1974); copper: Johnson and Christy,
Phys. Rev. B 6, 4370 (1972); aluminium: Rakic, Appl. Opt. 34, 4755 (1995).
"""

SOOT_REFLECTANCE = 0.04
"""Reflectance of soot."""
PIECE_FRACTION = 0.05
"""Fraction of a part's scratches and specks on a straight piece."""
BEAD_ROWS = 64
"""Rows of the bead's maps, from border to border."""
BEAD_PIXELS_PER_MM = 58.5
"""Columns of the bead's maps per mm along the weld."""


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceMaps:
    """Maps (H, W) float32, 0 to 1: reflectance relative to a clean metal, and fraction of soot over it."""

    reflectance: Texture
    soot: Texture


def plate_maps(part: Part) -> SurfaceMaps:
    """Return the partners from above, the weld in the middle: row = y down, column = x right."""
    rng = stream(part.seed, Stream.PLATE_TEXTURE)
    n = part.geometry.plate_texels
    per_mm = n / part.geometry.plate_mm
    image = np.full((n, n), part.surface.partner_reflectance, np.float32)
    stripes = sum(
        weight * _field(rng, n, (8.0, grain), per_mm)
        for weight, grain in ((0.5, 0.5), (0.35, 0.12), (0.4, 0.03))
    )
    amount = float(rng.uniform(0.03, 0.13))
    if Switch.PARTNER_STRIPES in part.switches:
        image += amount * np.asarray(stripes)
    image += 0.02 * _field(rng, n, (0.2, 0.2), per_mm)

    y, x = ((np.indices((n, n), np.float32) + 0.5) / per_mm - n / per_mm / 2).astype(np.float32)
    if part.dirt.heat_tint > 0:
        away = _away_mm(part, x, y)
        reach = float(rng.uniform(0.15, 0.6))
        rings = 0.75 + 0.25 * np.cos(away / reach * 9.0)
        patchy = 0.8 + 0.2 * _field(rng, n, (1.0, 1.0), per_mm)
        image *= 1.0 - 0.7 * part.dirt.heat_tint * np.exp(-((away / reach) ** 2)) * rings * patchy
    if part.surface.has_circles:
        _circles(rng, image, per_mm)
    _scratches_and_dust(part, rng, image, per_mm)
    return SurfaceMaps(np.clip(image, 0.03, 1.0), _soot_at_edges(part, rng, x, y))


def _soot_at_edges(part: Part, rng: np.random.Generator, x: Texture, y: Texture) -> Texture:
    """Return the soot on the partners: fading away from the weld's edges, thinner where no weld ran."""
    n = x.shape[0]
    if Switch.SOOT_AT_EDGES not in part.switches or part.dirt.soot == 0:
        return np.zeros((n, n), np.float32)
    away = _away_mm(part, x, y)
    grains = ((0.6, 1.2), (0.5, 0.5), (0.35, 0.2), (0.2, 0.07))
    cloud = sum(
        weight * _field(rng, n, (grain, grain), n / part.geometry.plate_mm) for weight, grain in grains
    )
    reach = float(rng.uniform(0.1, 0.6))
    amount = -2.2 + 2.2 * part.dirt.soot
    angle_rad = np.asarray(part.geometry.weld_coordinates(x, y)[0], np.float64)
    ran = np.where(bead_width(part, angle_rad) > 0, 1.0, 0.35)
    thick = np.clip((np.asarray(cloud) + amount) * 0.7 + 0.3, 0, 0.95)
    return np.asarray(thick * np.exp(-((away / reach) ** 2)) * ran, np.float32)


def _away_mm(part: Part, x: Texture, y: Texture) -> Texture:
    """Return the distance from the weld's border, 0 on the weld."""
    across = part.geometry.weld_coordinates(x, y)[1] - part.bead.radius_mm
    return np.asarray(np.maximum(np.abs(across) - part.bead.half_width_mm, 0), np.float32)


def _field(rng: np.random.Generator, n: int, grain_mm: tuple[float, float], per_mm: float) -> Texture:
    """Return noise of a grain in mm along (y, x), (n, n), made no finer than the grain needs."""
    shape = tuple(min(n, max(32, int(n / per_mm / g * 4))) for g in grain_mm)
    cells = (grain_mm[0] * per_mm * shape[0] / n, grain_mm[1] * per_mm * shape[1] / n)
    small = gaussian(rng, (shape[0], shape[1]), cells).astype(np.float32)
    return np.asarray(cv2.resize(small, (n, n), interpolation=cv2.INTER_LINEAR))


def _circles(rng: np.random.Generator, image: Texture, per_mm: float) -> None:
    """Draw a bore inside, a groove or step outside, roughly concentric: never where a weld could be."""
    middle = image.shape[0] / per_mm / 2
    for low, high, chance in ((1.2, 3.6, 0.6), (7.4, 9.2, 0.7), (9.3, 9.8, 0.3)):
        if rng.random() > chance:
            continue
        center = tuple(int(v * 256) for v in (middle + rng.uniform(-0.25, 0.25, 2)) * per_mm)
        radius = int(rng.uniform(low, high) * per_mm * 256)
        width = max(1, int(rng.uniform(0.04, 0.3) * per_mm))
        cv2.circle(image, center, radius, float(rng.uniform(0.05, 0.35)), width, cv2.LINE_AA, 8)


def _scratches_and_dust(part: Part, rng: np.random.Generator, image: Texture, per_mm: float) -> None:
    n = image.shape[0]
    for _ in range(part.geometry.number(rng, part.dirt.scratches, PIECE_FRACTION)):
        start = rng.uniform(0, n, 2)
        bend = rng.uniform(-0.4, 0.4)
        angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 4) * per_mm
        steps = np.linspace(0, 1, 30)[:, None]
        heading = angle + bend * steps
        curve = start + length * np.cumsum(np.hstack([np.cos(heading), np.sin(heading)]), axis=0) / 30
        shade = float(np.clip(image.mean() * rng.uniform(0.6, 1.25), 0, 1))
        cv2.polylines(image, [np.round(curve * 16).astype(np.int32)], False, shade, 1, cv2.LINE_AA, 4)
    for _ in range(part.geometry.number(rng, part.dirt.dust, PIECE_FRACTION)):
        center = tuple(int(v) for v in rng.uniform(0, n, 2))
        radius = max(1, int(rng.uniform(0.015, 0.05) * per_mm))
        cv2.circle(image, center, radius, float(rng.uniform(0.05, 0.4)), -1, cv2.LINE_AA)


def bead_maps(part: Part) -> SurfaceMaps:
    """Return the bead over (across, angle), (64, W): row 0 = inner border, column 0 = the first angle."""
    rng = stream(part.seed, Stream.BEAD_TEXTURE)
    length_mm, dirt = part.geometry.length_mm, part.dirt
    rows, columns = shape = (BEAD_ROWS, max(128, round(length_mm * BEAD_PIXELS_PER_MM)))
    cell = (rows / (2 * part.bead.half_width_mm), columns / length_mm)
    t = np.linspace(-1, 1, rows)[:, None]
    grain = 0.05 * gaussian(rng, shape, (0.19 * cell[0], 0.51 * cell[1]))
    reflectance = np.asarray(np.clip(part.surface.bead_reflectance + grain, 0, 1), np.float32)
    sharp = 1.0 - dirt.soot_softness
    patches = gaussian(rng, shape, (0.31 * cell[0], 1.0 * cell[1]))
    patches += (0.1 + 0.5 * sharp) * gaussian(rng, shape, (0.08 * cell[0], 0.12 * cell[1]))
    border = np.abs(t) ** 6 * np.clip(0.5 + 0.5 * gaussian(rng, shape, (rows, 1.4 * cell[1])), 0, 1)
    black, contrast = float(rng.uniform(0.45, 0.92)), 0.25 + float(rng.uniform(0.25, 2.0)) * sharp
    soot = np.zeros(shape)
    if Switch.SOOT_ON_WELD in part.switches and dirt.soot > 0:
        soot = np.clip(contrast * (patches - 2.2 + 2.4 * dirt.soot), 0, 1) * black
    if Switch.SOOT_AT_EDGES in part.switches:
        soot = np.maximum(soot, border * min(1.0, 1.2 * dirt.soot))
    _bead_scratches(part, reflectance)
    return SurfaceMaps(reflectance, np.asarray(np.clip(soot, 0, 0.95), np.float32))


def floor_reflectance(part: Part) -> Texture:
    """Return the reflectance (H, W) of what lies below holes and joint, from above as in `plate_maps`."""
    n = part.geometry.plate_texels
    field = _field(stream(part.seed, Stream.FLOOR_TEXTURE), n, (0.1, 0.1), n / part.geometry.plate_mm)
    uneven = np.exp(part.surface.floor_texture * field)
    return np.asarray(np.clip(part.surface.floor_reflectance * uneven, 0, 1), np.float32)


def _bead_scratches(part: Part, image: Texture) -> None:
    rng = stream(part.seed, Stream.BEAD_SCRATCHES)
    rows, columns = image.shape
    for _ in range(part.dirt.bead_scratches):
        start = rng.uniform((0, 0), (columns, rows))
        end = start + rng.uniform((-60, -rows), (60, rows))
        shade = float(np.clip(image.mean() * rng.uniform(0.55, 1.2), 0, 1))
        points = np.round(np.stack([start, end]) * 16).astype(np.int32)
        cv2.polylines(image, [points], False, shade, 1, cv2.LINE_AA, 4)

"""Surfaces as data: metals by name, and maps of reflectance and soot for bead and partners. numpy and OpenCV drawing only.

Stripes, scratches, dust, heat tint and the part's other circles change the metal's reflectance; soot is a share of another BSDF.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.part.switches import Switch
from synth.surface.noise import gaussian

Texture = NDArray[np.float32]

METALS = {
    "steel": (2.95, 2.93),
    "aluminium": (0.963, 6.70),
    "copper": (1.02, 2.577),
    "nickel-plated": (1.92, 3.61),
}
"""Complex refractive index eta + i k at 550 nm. Iron (for steel) and nickel: Johnson and Christy, Phys. Rev. B 9, 5056 (1974);
copper: Johnson and Christy, Phys. Rev. B 6, 4370 (1972); aluminium: Rakic, Appl. Opt. 34, 4755 (1995)."""

SOOT_REFLECTANCE = 0.04
PIECE_FRACTION = 0.05
"""Fraction of a part's scratches and specks that a straight piece has."""
BEAD_ROWS = 64


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Maps (H, W) float32 in [0, 1]: reflectance of the metal against a clean one, and the share of soot over it."""

    reflectance: Texture
    soot: Texture


def plate_surface(part: Part) -> Surface:
    """Partners from above, `plate_mm(part)` a side, weld in the middle: row = y down, column = x right."""
    rng = stream(part.seed, Stream.PLATE_TEXTURE)
    n = part.geometry.plate_texels
    mm = n / part.geometry.plate_mm
    image = np.full((n, n), part.partner_reflectance, np.float32)
    stripes = sum(weight * _field(rng, n, (8.0, grain), mm) for weight, grain in ((0.5, 0.5), (0.35, 0.12), (0.4, 0.03)))
    amount = float(rng.uniform(0.03, 0.13))
    if Switch.PARTNER_STRIPES in part.switches:
        image += amount * np.asarray(stripes)
    image += 0.02 * _field(rng, n, (0.2, 0.2), mm)

    y, x = ((np.indices((n, n), np.float32) + 0.5) / mm - n / mm / 2).astype(np.float32)
    if part.heat_tint > 0:
        away = _away(part, x, y)
        reach = float(rng.uniform(0.15, 0.6))
        rings = 0.75 + 0.25 * np.cos(away / reach * 9.0)
        image *= 1.0 - 0.7 * part.heat_tint * np.exp(-((away / reach) ** 2)) * rings * (0.8 + 0.2 * _field(rng, n, (1.0, 1.0), mm))
    if part.circles:
        _circles(rng, image, mm)
    _scratches_and_dust(part, rng, image, mm)
    return Surface(np.clip(image, 0.03, 1.0), _soot_beside(part, rng, x, y, mm))


def _soot_beside(part: Part, rng: np.random.Generator, x: Texture, y: Texture, mm: float) -> Texture:
    """Soot fades away from the weld's edges, and is thinner where no weld ran."""
    n = x.shape[0]
    if Switch.SOOT_AT_EDGES not in part.switches or part.soot == 0:
        return np.zeros((n, n), np.float32)
    away = _away(part, x, y)
    cloud = sum(weight * _field(rng, n, (grain, grain), mm) for weight, grain in ((0.6, 1.2), (0.5, 0.5), (0.35, 0.2), (0.2, 0.07)))
    reach = float(rng.uniform(0.1, 0.6))
    amount = -2.2 + 2.2 * part.soot
    angle = np.rad2deg(part.geometry.weld_coordinates(x, y)[0])
    ran = np.ones_like(x)
    for arc in part.missing:
        ran[(angle - arc.start_deg) % 360 <= arc.end_deg - arc.start_deg] = 0.35
    return np.asarray(np.clip((np.asarray(cloud) + amount) * 0.7 + 0.3, 0, 0.95) * np.exp(-((away / reach) ** 2)) * ran, np.float32)


def _away(part: Part, x: Texture, y: Texture) -> Texture:
    """Distance from the weld's border, 0 on the weld, mm."""
    across = part.geometry.weld_coordinates(x, y)[1] - part.radius_mm
    return np.asarray(np.maximum(np.abs(across) - part.half_width_mm, 0), np.float32)


def _field(rng: np.random.Generator, n: int, grain_mm: tuple[float, float], mm: float) -> Texture:
    """Noise of a grain in mm along (y, x), (n, n), made no finer than the grain needs."""
    shape = tuple(min(n, max(32, int(n / mm / g * 4))) for g in grain_mm)
    cells = (grain_mm[0] * mm * shape[0] / n, grain_mm[1] * mm * shape[1] / n)
    small = gaussian(rng, (shape[0], shape[1]), cells).astype(np.float32)
    return np.asarray(cv2.resize(small, (n, n), interpolation=cv2.INTER_LINEAR))


def _circles(rng: np.random.Generator, image: Texture, mm: float) -> None:
    """Bore inside, groove or step outside, roughly concentric: never where a weld could be."""
    middle = image.shape[0] / mm / 2
    for low, high, chance in ((1.2, 3.6, 0.6), (7.4, 9.2, 0.7), (9.3, 9.8, 0.3)):
        if rng.random() > chance:
            continue
        center = tuple(int(v * 256) for v in (middle + rng.uniform(-0.25, 0.25, 2)) * mm)
        radius, width = int(rng.uniform(low, high) * mm * 256), max(1, int(rng.uniform(0.04, 0.3) * mm))
        cv2.circle(image, center, radius, float(rng.uniform(0.05, 0.35)), width, cv2.LINE_AA, 8)


def _scratches_and_dust(part: Part, rng: np.random.Generator, image: Texture, mm: float) -> None:
    n = image.shape[0]
    for _ in range(part.geometry.number(rng, part.scratches, PIECE_FRACTION)):
        start = rng.uniform(0, n, 2)
        bend = rng.uniform(-0.4, 0.4)
        angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 4) * mm
        steps = np.linspace(0, 1, 30)[:, None]
        heading = angle + bend * steps
        curve = start + length * np.cumsum(np.hstack([np.cos(heading), np.sin(heading)]), axis=0) / 30
        shade = float(np.clip(image.mean() * rng.uniform(0.6, 1.25), 0, 1))
        cv2.polylines(image, [np.round(curve * 16).astype(np.int32)], False, shade, 1, cv2.LINE_AA, 4)
    for _ in range(part.geometry.number(rng, part.dust, PIECE_FRACTION)):
        center = tuple(int(v) for v in rng.uniform(0, n, 2))
        cv2.circle(image, center, max(1, int(rng.uniform(0.015, 0.05) * mm)), float(rng.uniform(0.05, 0.4)), -1, cv2.LINE_AA)


def bead_surface(part: Part, length_mm: float) -> Surface:
    """Bead over (across, angle), (64, W) with `length_mm` along W: row 0 = inner border, column 0 = the first angle."""
    rng = stream(part.seed, Stream.BEAD_TEXTURE)
    rows, columns = shape = (BEAD_ROWS, max(128, round(length_mm * 58.5)))
    cell = (rows / (2 * part.half_width_mm), columns / length_mm)
    t = np.linspace(-1, 1, rows)[:, None]
    image = np.clip(part.bead_reflectance + 0.05 * gaussian(rng, shape, (0.19 * cell[0], 0.51 * cell[1])), 0, 1)
    sharp = 1.0 - part.soot_softness
    patches = gaussian(rng, shape, (0.31 * cell[0], 1.0 * cell[1])) + (0.1 + 0.5 * sharp) * gaussian(
        rng, shape, (0.08 * cell[0], 0.12 * cell[1])
    )
    border = np.abs(t) ** 6 * np.clip(0.5 + 0.5 * gaussian(rng, shape, (rows, 1.4 * cell[1])), 0, 1)
    soot = np.zeros(shape)
    black = float(rng.uniform(0.45, 0.92))
    if Switch.SOOT_ON_WELD in part.switches:
        soot = np.maximum(
            soot,
            np.clip((0.25 + float(rng.uniform(0.25, 2.0)) * sharp) * (patches - 2.2 + 2.4 * part.soot), 0, 1)
            * black
            * float(part.soot > 0),
        )
    if Switch.SOOT_AT_EDGES in part.switches:
        soot = np.maximum(soot, border * min(1.0, 1.2 * part.soot))
    reflectance = np.asarray(image, np.float32)
    _bead_scratches(part, reflectance)
    return Surface(reflectance, np.asarray(np.clip(soot, 0, 0.95), np.float32))


def floor_reflectance(part: Part) -> Texture:
    """Reflectance of what lies below holes and joint, seen from above as `plate_surface`, (H, W)."""
    n = part.geometry.plate_texels
    field = _field(stream(part.seed, Stream.FLOOR_TEXTURE), n, (0.1, 0.1), n / part.geometry.plate_mm)
    return np.asarray(np.clip(part.floor_reflectance * np.exp(part.floor_texture * field), 0, 1), np.float32)


def _bead_scratches(part: Part, image: Texture) -> None:
    rng = stream(part.seed, Stream.BEAD_SCRATCHES)
    rows, columns = image.shape
    for _ in range(part.bead_scratches):
        start = rng.uniform((0, 0), (columns, rows))
        end = start + rng.uniform((-60, -rows), (60, rows))
        shade = float(np.clip(image.mean() * rng.uniform(0.55, 1.2), 0, 1))
        points = np.round(np.stack([start, end]) * 16).astype(np.int32)
        cv2.polylines(image, [points], False, shade, 1, cv2.LINE_AA, 4)

"""Reflectance textures of bead and partners, float32 in [0, 1], numpy and OpenCV drawing only.

Stripes, soot, scratches, dust and the part's other circles (bores, grooves) live here, as darker metal.
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.mesh import PLATE_MM
from synth.part import Part
from synth.topography import noise

Texture = NDArray[np.float32]

PLATE_TEXELS = 1536


def plate_texture(part: Part) -> Texture:
    """Partners from above, (1536, 1536): row = y down, column = x right, `PLATE_MM` a side, ring in the middle."""
    rng = np.random.default_rng([part.seed, 5])
    n = PLATE_TEXELS
    mm = n / PLATE_MM
    stripes = sum(weight * _field(rng, (96, n), (8.0, grain * mm)) for weight, grain in ((0.5, 0.5), (0.35, 0.12), (0.4, 0.03)))
    image = part.partner_reflectance + float(rng.uniform(0.02, 0.10)) * np.asarray(stripes) + 0.02 * _field(rng, (384, 384), (12.0, 12.0))

    y, x = ((np.indices((n, n), np.float32) + 0.5) / mm - PLATE_MM / 2).astype(np.float32)
    away = np.maximum(np.abs(np.hypot(x, y) - part.radius_mm) - part.half_width_mm, 0)
    cloud = sum(
        weight * _field(rng, (768, 768), (grain * mm / 2, grain * mm / 2))
        for weight, grain in ((0.7, 2.5), (0.4, 0.6), (0.35, 0.2), (0.2, 0.07))
    )
    reach_mm, amount = float(rng.uniform(0.2, 0.7)), float(rng.uniform(-2.2, 0.6))
    soot = np.clip((np.asarray(cloud) + amount) * 0.7 + 0.3, 0, 1) * np.exp(-((away / reach_mm) ** 2))
    image = np.asarray(np.clip(image * (1 - 0.85 * soot), 0.03, 1.0), np.float32)

    _circles(rng, image, mm)
    _scratches_and_dust(rng, image, mm)
    return image


def _field(rng: np.random.Generator, shape: tuple[int, int], cells: tuple[float, float]) -> Texture:
    """Noise made on a coarser grid, (1536, 1536)."""
    size = (PLATE_TEXELS, PLATE_TEXELS)
    return np.asarray(cv2.resize(noise(rng, shape, cells).astype(np.float32), size, interpolation=cv2.INTER_LINEAR))


def _circles(rng: np.random.Generator, image: Texture, mm: float) -> None:
    """Bore inside, groove or step outside, roughly concentric: never where a weld could be."""
    for low, high, chance in ((1.2, 3.6, 0.6), (7.4, 9.2, 0.7), (9.3, 9.8, 0.3)):
        if rng.random() > chance:
            continue
        center = tuple(int(v * 256) for v in (PLATE_MM / 2 + rng.uniform(-0.25, 0.25, 2)) * mm)
        radius, width = int(rng.uniform(low, high) * mm * 256), max(1, int(rng.uniform(0.04, 0.3) * mm))
        cv2.circle(image, center, radius, float(rng.uniform(0.05, 0.35)), width, cv2.LINE_AA, 8)


def _scratches_and_dust(rng: np.random.Generator, image: Texture, mm: float) -> None:
    n = image.shape[0]
    for _ in range(int(rng.integers(0, 14))):
        start = rng.uniform(0, n, 2)
        bend = rng.uniform(-0.4, 0.4)
        angle, length = rng.uniform(0, 2 * np.pi), rng.uniform(0.5, 4) * mm
        steps = np.linspace(0, 1, 30)[:, None]
        heading = angle + bend * steps
        curve = start + length * np.cumsum(np.hstack([np.cos(heading), np.sin(heading)]), axis=0) / 30
        shade = float(np.clip(image.mean() * rng.uniform(0.6, 1.25), 0, 1))
        cv2.polylines(image, [np.round(curve * 16).astype(np.int32)], False, shade, 1, cv2.LINE_AA, 4)
    for _ in range(int(rng.integers(0, 40))):
        center = tuple(int(v) for v in rng.uniform(0, n, 2))
        cv2.circle(image, center, int(rng.integers(1, 4)), float(rng.uniform(0.05, 0.4)), -1, cv2.LINE_AA)


def bead_texture(part: Part) -> Texture:
    """Bead over (across, angle), (64, 2048): row 0 = inner border, column 0 = angle 0; soot darkens patches and borders."""
    rng = np.random.default_rng([part.seed, 6])
    shape = (64, 2048)
    t = np.linspace(-1, 1, shape[0])[:, None]
    image = np.clip(part.bead_reflectance + 0.05 * noise(rng, shape, (12, 30)), 0, 1)
    patches = np.clip(noise(rng, shape, (20, 60)) + rng.uniform(-2.5, 0.2), 0, 1)
    border = np.abs(t) ** 6 * np.clip(0.5 + 0.5 * noise(rng, shape, (64, 80)), 0, 1) * rng.uniform(0, 0.8)
    sooty = np.asarray(image * (1 - 0.6 * patches) * (1 - border), np.float32)
    _bead_scratches(part, sooty)
    return sooty


def _bead_scratches(part: Part, image: Texture) -> None:
    rng = np.random.default_rng([part.seed, 10])
    rows, columns = image.shape
    for _ in range(part.bead_scratches):
        start = rng.uniform((0, 0), (columns, rows))
        end = start + rng.uniform((-60, -rows), (60, rows))
        shade = float(np.clip(image.mean() * rng.uniform(0.55, 1.2), 0, 1))
        points = np.round(np.stack([start, end]) * 16).astype(np.int32)
        cv2.polylines(image, [points], False, shade, 1, cv2.LINE_AA, 4)

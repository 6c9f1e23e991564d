"""Things that hide a weld, drawn over training crops: what each changes, and how much of the weld it hides.

A cover is a function of a generator, a crop and a spare picture of the same size. It returns the picture that
is seen where the crop is covered, and how far that hides the weld (1: wholly, 0: not at all).
"""

from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENT_PX

Picture = NDArray[np.float32]
"""Crop (128, 128) float32, grey levels 0 to 255."""
Cover = Callable[[np.random.Generator, Picture, Picture], tuple[Picture, float]]
"""Function of generator, crop and spare picture to what is seen instead, and how far it hides the weld."""


def flat(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return one grey level, from black to white, with the sensor's noise or without."""
    level = float(rng.choice([0, 255, rng.uniform(0, 255)], p=[0.2, 0.2, 0.6]))
    noise = rng.standard_normal(crop.shape, np.float32) * np.float32(rng.uniform(0, 5) * (rng.random() < 0.7))
    return level + noise, 1.0


def gradient(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return a smooth surface: slowly changing grey levels, as of a finger, a glove or a cable."""
    size = int(rng.integers(2, 6))
    nodes = rng.uniform(0, 255, (size, size)).astype(np.float32) * np.float32(rng.uniform(0.1, 1))
    smooth = _sized(nodes, cv2.INTER_CUBIC) + np.float32(rng.uniform(0, 150))
    grain = _noise(rng, crop.shape, float(np.exp(rng.uniform(np.log(0.5), np.log(8)))))
    return np.clip(smooth + grain * np.float32(rng.uniform(0, 14)), 0, 255), 1.0


def noise(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return noise of one grain, in any direction."""
    grain = np.exp(rng.uniform(np.log(0.4), np.log(12), 2))
    field = _noise(rng, crop.shape, float(grain[0]), float(grain[1]) if rng.random() < 0.5 else None)
    return np.clip(rng.uniform(20, 220) + field * rng.uniform(3, 60), 0, 255).astype(np.float32), 1.0


def stripes(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return stripes or a grid, as of a cloth, a tape or a printed code."""
    y, x = np.indices(crop.shape, np.float32)
    angle, pitch = rng.uniform(0, np.pi), float(np.exp(rng.uniform(np.log(3), np.log(40))))
    u, v = x * np.cos(angle) + y * np.sin(angle), y * np.cos(angle) - x * np.sin(angle)
    wave = np.sin(2 * np.pi * u / pitch)
    if rng.random() < 0.5:
        wave = wave * np.sin(2 * np.pi * v / (pitch * rng.uniform(0.6, 1.6)))
    if rng.random() < 0.5:
        wave = np.sign(wave)
    texture = (
        rng.uniform(30, 200) + wave * rng.uniform(5, 80) + _noise(rng, crop.shape, 1.0) * rng.uniform(0, 8)
    )
    return np.clip(texture, 0, 255).astype(np.float32), 1.0


def sheet(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the sheet's own texture, from beside the weld."""
    return spare * np.float32(rng.uniform(0.7, 1.3)), 1.0


def blur(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the crop out of focus."""
    sigma = float(np.exp(rng.uniform(np.log(3.0), np.log(20))))
    seen = cv2.GaussianBlur(crop, (0, 0), sigma, borderType=cv2.BORDER_REFLECT)
    return _grainy(rng, np.asarray(seen, np.float32)), float(np.clip((sigma - 3.0) / 2.0, 0, 1))


def motion(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the crop smeared along a line."""
    length = float(np.exp(rng.uniform(np.log(12), np.log(70))))
    angle, half = rng.uniform(0, np.pi), int(length // 2) + 1
    kernel = np.zeros((2 * half + 1, 2 * half + 1), np.float32)
    end = np.array([np.cos(angle), np.sin(angle)]) * length / 2
    first, last = (tuple(round(v * 16) for v in half + sign * end) for sign in (-1, 1))
    cv2.line(kernel, first, last, 1.0, 1, cv2.LINE_AA, 4)
    seen = cv2.filter2D(crop, -1, kernel / kernel.sum(), borderType=cv2.BORDER_REFLECT)
    return _grainy(rng, np.asarray(seen, np.float32)), float(np.clip((length - 12) / 10, 0, 1))


def shadow(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the crop with hardly any light left."""
    gain = float(rng.uniform(0.0, 0.25))
    return _grainy(rng, crop * np.float32(gain)), float(np.clip((0.2 - gain) / 0.1, 0, 1))


def glare(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the crop under a reflection that saturates most of it."""
    added = float(rng.uniform(120, 400))
    return np.clip(crop * np.float32(rng.uniform(0.3, 1.0)) + np.float32(added), 0, 255), float(added > 200)


def film(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the crop behind a film of dust, powder or fog: little contrast is left."""
    thick = float(rng.uniform(0.5, 0.98))
    dust = rng.uniform(30, 240) + _noise(
        rng, crop.shape, float(np.exp(rng.uniform(np.log(0.6), np.log(15))))
    ) * rng.uniform(1, 25)
    return (crop * (1 - thick) + dust * thick).astype(np.float32), float(np.clip((thick - 0.6) / 0.2, 0, 1))


def drop(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the crop through liquid: bent by a film or by drops that are lenses, with highlights."""
    y, x = np.indices(crop.shape, np.float32)
    bend = rng.uniform(6, 25)
    dx, dy = (_noise(rng, crop.shape, float(rng.uniform(8, 30))) * np.float32(bend) for _ in range(2))
    if rng.random() < 0.6:
        dx, dy = np.zeros_like(x), np.zeros_like(y)
        for _ in range(int(rng.integers(3, 30))):
            middle_x, middle_y = rng.uniform(-20, 148, 2)
            inside = np.hypot(x - middle_x, y - middle_y) < rng.uniform(15, 90)
            power = np.float32(rng.uniform(-4, 1.5))
            dx[inside], dy[inside] = (power * (at - m)[inside] for at, m in ((x, middle_x), (y, middle_y)))
    seen = cv2.remap(crop, x + dx, y + dy, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
    seen = cv2.GaussianBlur(seen, (0, 0), float(rng.uniform(1, 5)))
    light = np.clip(_noise(rng, crop.shape, 18.0) - 1.2, 0, None) * np.float32(rng.uniform(0, 300))
    return np.clip(seen * np.float32(rng.uniform(0.5, 1.2)) + light, 0, 255), 1.0


def blocks(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return lost data: coarse blocks or rows out of place."""
    size = int(rng.integers(8, 33))
    if rng.random() < 0.5:
        small = cv2.resize(crop, None, fx=1 / size, fy=1 / size, interpolation=cv2.INTER_AREA)
        return _sized(np.asarray(small, np.float32), cv2.INTER_NEAREST), 1.0
    rows = np.arange(crop.shape[0])
    shift = rng.permutation(rows) if rng.random() < 0.5 else rows * int(rng.integers(3, 40))
    return np.stack([np.roll(crop[row], int(shift[row])) for row in rows]), 1.0


def turned(rng: np.random.Generator, crop: Picture, spare: Picture) -> tuple[Picture, float]:
    """Return the weld out of place: turned, mirrored or at another size, as in a mirror or a lens."""
    middle = (SEGMENT_PX - 1) / 2
    angle, scale = rng.uniform(50, 310), float(np.exp(rng.uniform(-0.7, 0.7)))
    turn = cv2.getRotationMatrix2D((middle, middle), angle if angle < 130 or angle > 230 else 90.0, scale)
    seen = cv2.warpAffine(crop, turn, (SEGMENT_PX, SEGMENT_PX), borderMode=cv2.BORDER_REFLECT)
    soft = cv2.GaussianBlur(seen, (0, 0), float(rng.uniform(0.5, 3)))
    return np.asarray(soft * np.float32(rng.uniform(0.6, 1.2)), np.float32), 1.0


COVERS: dict[str, Cover] = {
    "flat": flat,
    "gradient": gradient,
    "noise": noise,
    "stripes": stripes,
    "sheet": sheet,
    "blur": blur,
    "motion": motion,
    "shadow": shadow,
    "glare": glare,
    "film": film,
    "drop": drop,
    "blocks": blocks,
    "turned": turned,
}
"""Covers by name."""


WEIGHTS = {"sheet": 2.0, "blur": 1.5, "motion": 3.0, "drop": 4.0, "film": 1.5, "blocks": 1.5, "turned": 1.5}
"""How often a cover is drawn, if not once: those that are hard to tell from a weld more often."""


def cover(
    rng: np.random.Generator, crop: Picture, spare: Picture, names: Sequence[str]
) -> tuple[Picture, Picture]:
    """Return a crop with one cover of `names` over part of it, and how far each pixel is hidden, 0 to 1."""
    weights = np.array([WEIGHTS.get(name, 1.0) for name in names])
    seen, hides = COVERS[str(rng.choice(list(names), p=weights / weights.sum()))](rng, crop, spare)
    mask = _shape(rng, crop.shape)
    return np.asarray(crop + mask * (seen - crop), np.float32), np.asarray(
        mask * np.float32(hides), np.float32
    )


def _shape(rng: np.random.Generator, shape: tuple[int, ...]) -> Picture:
    """Return where a cover lies, 0 to 1: a band of columns, a disc, a half plane, a finger, blobs or all."""
    y, x = np.indices(shape, np.float32)
    side = shape[1]
    kind = rng.integers(0, 6)
    angle = rng.uniform(0, 2 * np.pi)
    u = (x - rng.uniform(0, side)) * np.cos(angle) + (y - rng.uniform(0, side)) * np.sin(angle)
    v = (y - rng.uniform(0, side)) * np.cos(angle) - (x - rng.uniform(0, side)) * np.sin(angle)
    if kind == 0:
        inside = np.full(shape, 50.0)
    elif kind == 1:
        inside = np.minimum(x - rng.uniform(-60, 90), rng.uniform(40, 200) - x)
    elif kind == 2:
        inside = rng.uniform(15, 90) - np.hypot(u, v)
    elif kind == 3:
        inside = u
    elif kind == 4:
        inside = rng.uniform(12, 60) - np.where(u > 0, np.hypot(u, v), np.abs(v))
    else:
        inside = (_noise(rng, shape, float(rng.uniform(8, 40))) - rng.uniform(-1, 1)) * 15
    soft = float(np.exp(rng.uniform(np.log(0.5), np.log(12))))
    return np.asarray(np.clip(0.5 + inside / (2 * soft), 0, 1), np.float32)


def _sized(picture: Picture, interpolation: int) -> Picture:
    return np.asarray(cv2.resize(picture, (SEGMENT_PX, SEGMENT_PX), interpolation=interpolation), np.float32)


def _noise(
    rng: np.random.Generator, shape: tuple[int, ...], sigma: float, sigma_y: float | None = None
) -> Picture:
    """Return smooth noise of standard deviation 1."""
    field = rng.standard_normal(shape, np.float32)
    if sigma > 0.5:
        soft = cv2.GaussianBlur(field, (0, 0), sigma, sigmaY=sigma_y or sigma, borderType=cv2.BORDER_REFLECT)
        field = np.asarray(soft, np.float32)
    return np.asarray((field - field.mean()) / max(float(field.std()), 1e-6), np.float32)


def _grainy(rng: np.random.Generator, picture: Picture) -> Picture:
    """Add the sensor's noise, most of the time."""
    strength = np.float32(rng.uniform(0, 4) * (rng.random() < 0.7))
    return np.asarray(picture + rng.standard_normal(picture.shape, np.float32) * strength, np.float32)

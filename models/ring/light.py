"""Changes light, lens and camera of a sample, beyond what the generator draws."""

import cv2
import numpy as np
from numpy.typing import NDArray

from station.vision.reduced import FINDER_UM_PER_PX

COARSEST_UM_PER_PX = 65.0
"""Scale of the coarsest camera."""
LOG_BRIGHTNESS = (np.log(12.0), np.log(170.0))
"""Logarithms of the lowest and highest mean grey level that an exposure gives."""

Field = NDArray[np.float32]


def relight(image: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """Return a sample (N, N) under another light, through another lens and camera."""
    if rng.random() < 0.08:
        image = 255 - image
    relit = _lens(image.astype(np.float32), rng)
    if rng.random() < 0.35:
        middle = float(relit.mean())
        relit = middle + (relit - middle) * float(rng.uniform(0.15, 0.9))
    brightness, gamma = float(np.exp(rng.uniform(*LOG_BRIGHTNESS))), float(np.exp(rng.uniform(-0.5, 0.5)))
    gain = brightness / max(1.0, float(relit.mean())) if rng.random() < 0.6 else 1.0
    relit = np.asarray(255 * np.clip(relit * gain / 255, 0, 1) ** gamma, np.float32)
    if rng.random() < 0.5:
        relit = relit * _uneven(relit.shape[0], rng)
    if rng.random() < 0.25:
        relit = relit + _glare(relit.shape[0], rng)
    strength = float(rng.exponential(3.0)) if rng.random() < 0.6 else 0.5
    noisy = relit + rng.standard_normal(relit.shape, dtype=np.float32) * strength
    answer = np.clip(np.round(noisy), 0, 255).astype(np.uint8)
    if rng.random() < 0.08:
        _, packed = cv2.imencode(".jpg", answer, [cv2.IMWRITE_JPEG_QUALITY, int(rng.integers(25, 90))])
        answer = np.asarray(cv2.imdecode(packed, cv2.IMREAD_GRAYSCALE), np.uint8)
    return answer


def _lens(image: Field, rng: np.random.Generator) -> Field:
    """Return the sample blurred, sharpened, or seen by a coarser camera."""
    kind = rng.random()
    if kind < 0.3:
        return np.asarray(cv2.GaussianBlur(image, (0, 0), float(rng.uniform(0.4, 2.0))), np.float32)
    if kind < 0.4:
        soft = cv2.GaussianBlur(image, (0, 0), 1.0)
        return np.clip(image + float(rng.uniform(0.2, 1.0)) * (image - soft), 0, 255).astype(np.float32)
    if kind < 0.6:
        side = image.shape[0]
        coarse = round(side * FINDER_UM_PER_PX / rng.uniform(FINDER_UM_PER_PX, COARSEST_UM_PER_PX))
        small = cv2.resize(image, (coarse, coarse), interpolation=cv2.INTER_AREA)
        return np.asarray(cv2.resize(small, (side, side), interpolation=cv2.INTER_LINEAR), np.float32)
    return image


def _uneven(side: int, rng: np.random.Generator) -> Field:
    """Return a factor (side, side): a gradient, a falling off to the edges, or a half shadow."""
    rows, columns = np.indices((side, side), np.float32) / side - 0.5
    heading = float(rng.uniform(0, 2 * np.pi))
    along = columns * np.float32(np.cos(heading)) + rows * np.float32(np.sin(heading))
    kind = rng.random()
    if kind < 0.4:
        return np.asarray(1 + along * np.float32(rng.uniform(0, 1.6)), np.float32).clip(0.05)
    if kind < 0.7:
        x, y = rng.uniform(-0.5, 0.5, 2)
        away = (columns - np.float32(x)) ** 2 + (rows - np.float32(y)) ** 2
        return np.asarray(np.exp(-away * np.float32(rng.uniform(0.5, 6.0))).clip(0.04), np.float32)
    edge, soft = float(rng.uniform(-0.4, 0.4)), float(np.exp(rng.uniform(np.log(0.003), np.log(0.3))))
    dark = float(rng.uniform(0.05, 0.7))
    return np.asarray(dark + (1 - dark) / (1 + np.exp(-((along - edge) / soft).clip(-30, 30))), np.float32)


def _glare(side: int, rng: np.random.Generator) -> Field:
    """Return what one to three glares add (side, side)."""
    rows, columns = np.indices((side, side), np.float32)
    added = np.zeros((side, side), np.float32)
    for _ in range(int(rng.integers(1, 4))):
        x, y = rng.uniform(0, side, 2).astype(np.float32)
        wide, long = np.exp(rng.uniform(np.log(8), np.log(90), 2)).astype(np.float32)
        heading = rng.uniform(0, np.pi)
        cos, sin = np.float32(np.cos(heading)), np.float32(np.sin(heading))
        across = ((columns - x) * cos + (rows - y) * sin) / wide
        along = ((rows - y) * cos - (columns - x) * sin) / long
        added += np.float32(rng.uniform(30, 300)) * np.exp(-0.5 * (across**2 + along**2))
    return added

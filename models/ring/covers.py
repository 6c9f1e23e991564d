"""Covers a part of a sample: with an even patch, with noise, or with a piece of another sample."""

import cv2
import numpy as np
from numpy.typing import NDArray

MAX_COVERS = 3
"""Largest number of covers on a sample."""

Image = NDArray[np.uint8]


def cover(image: Image, masks: Image, *, other: Image, other_masks: Image, rng: np.random.Generator) -> None:
    """Cover parts of `image` (N, N) and of `masks` (N, N, 2) in place.

    What a piece of `other` shows is marked as there; below any other cover nothing is.
    """
    for _ in range(int(rng.integers(1, MAX_COVERS + 1))):
        hidden = _shape(image.shape[0], rng)
        kind = rng.random()
        if kind < 0.4:
            image[hidden], masks[hidden] = other[hidden], other_masks[hidden]
            continue
        grey, spread = float(rng.uniform(0, 255)), float(rng.uniform(0, 40)) if kind < 0.7 else 0.0
        noise = rng.standard_normal(image.shape, dtype=np.float32)
        if rng.random() < 0.5:
            noise = np.asarray(3 * cv2.GaussianBlur(noise, (0, 0), 1.5), np.float32)
        patch = np.clip(grey + spread * noise, 0, 255).astype(np.uint8)
        image[hidden], masks[hidden] = patch[hidden], 0


def _shape(side: int, rng: np.random.Generator) -> NDArray[np.bool_]:
    """Return which pixels (side, side) a random rectangle, ellipse, half plane or polygon hides."""
    shape = np.zeros((side, side), np.uint8)
    x, y = (float(v) for v in rng.uniform(0, side, 2))
    size = (float(v) for v in np.exp(rng.uniform(np.log(12), np.log(150), 2)))
    kind, turn = rng.random(), float(rng.uniform(0, 360))
    if kind < 0.4:
        corners = cv2.boxPoints(((x, y), tuple(size), turn))
        cv2.fillPoly(shape, [corners.astype(np.int32)], 1)
    elif kind < 0.7:
        cv2.ellipse(shape, ((x, y), tuple(size), turn), 1, -1)
    elif kind < 0.8:
        rows, columns = np.indices(shape.shape)
        heading = np.radians(turn)
        away = (columns - side / 2) * np.cos(heading) + (rows - side / 2) * np.sin(heading)
        shape[away > rng.uniform(0, 0.5) * side] = 1
    else:
        angle = np.sort(rng.uniform(0, 2 * np.pi, 7))
        far = rng.uniform(8, 70, 7)
        corners = np.stack([x + far * np.cos(angle), y + far * np.sin(angle)], axis=1)
        cv2.fillPoly(shape, [corners.astype(np.int32)], 1)
    return shape.astype(bool)

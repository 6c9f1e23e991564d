"""Changes to a crop that keep its label true: mirror, light, contrast, blur, noise."""

import cv2
import numpy as np
from numpy.typing import NDArray


def augment(crop: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """A changed copy of a crop (128, 128) uint8. Mirroring the rows swaps the partners, the columns the direction."""
    turned = np.ascontiguousarray(crop[:: rng.choice((-1, 1)), :: rng.choice((-1, 1))])
    blurred = cv2.GaussianBlur(turned, (0, 0), float(rng.uniform(0.4, 1.6))) if rng.random() < 0.4 else turned
    gain, gamma = float(np.exp(rng.uniform(-0.7, 0.7))), float(np.exp(rng.uniform(-0.4, 0.4)))
    image = 255.0 * np.clip(blurred.astype(np.float32) * gain / 255.0, 0, 1) ** gamma
    if rng.random() < 0.5:
        slope = rng.uniform(-0.4, 0.4, 2)
        ramp = np.linspace(-1, 1, crop.shape[0])
        image = image * (1 + slope[0] * ramp[:, None] + slope[1] * ramp[None, :]).clip(0.2)
    image = image + rng.standard_normal(image.shape, dtype=np.float32) * float(rng.uniform(0, 5))
    return np.asarray(np.clip(image, 0, 255), np.uint8)

"""From radiance to the grey levels of a camera: exposure, lens, veil, noise."""

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.heightfield.grid import Field
from synth.part.ranges import log_uniform, uniform


def photograph(
    rng: np.random.Generator, radiance: Field, x_mm: Field, y_mm: Field, *, factor: int
) -> NDArray[np.uint8]:
    """Return the picture (H / factor, W / factor) uint8 of a radiance (H, W)."""
    cell = float(x_mm[0, 1] - x_mm[0, 0])
    blur_mm = log_uniform(rng, (0.004, 0.022))
    seen = cv2.GaussianBlur(radiance, (0, 0), max(blur_mm / cell, 0.3))
    if rng.random() < 0.5:  # light that falls off, or a lens that does
        slope = rng.normal(size=2) * uniform(rng, (0, 0.05))
        away = (x_mm**2 + y_mm**2) * np.float32(uniform(rng, (0, 0.003)))
        seen = seen * np.clip(1 + x_mm * np.float32(slope[0]) + y_mm * np.float32(slope[1]) - away, 0.1, 2.5)
    if factor > 1:
        side = seen.shape[0] // factor
        seen = cv2.resize(seen, (side, side), interpolation=cv2.INTER_AREA)
    level = float(np.percentile(seen, uniform(rng, (40, 97))))
    grey = seen / max(level, 1e-6) * np.float32(log_uniform(rng, (40, 200)))
    grey = grey + np.float32(uniform(rng, (0, 12)) * (rng.random() < 0.5))
    if rng.random() < 0.3:
        grey = 255 * np.clip(grey / 255, 0, 1) ** np.float32(log_uniform(rng, (0.6, 1.5)))
    noisy = grey + rng.standard_normal(grey.shape, dtype=np.float32) * np.sqrt(
        np.float32(uniform(rng, (0.3, 3)) ** 2) + np.maximum(grey, 0) * np.float32(uniform(rng, (0, 0.05)))
    )
    return np.asarray(np.clip(np.round(noisy), 0, 255), np.uint8)

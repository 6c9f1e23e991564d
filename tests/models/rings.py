"""Small lots of pictures with masks, made in code: striped rings on even sheets."""

import json
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

SIDE = 240
"""Side of a picture in pixels of 52 µm."""


def ring_picture(
    rng: np.random.Generator, *, x: float, y: float, radius: float, half_width: float = 8.0
) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """A bead with ripples across it on a sheet with noise, and its mask."""
    rows, columns = np.indices((SIDE, SIDE))
    away = np.hypot(columns - x, rows - y) - radius
    along = np.arctan2(rows - y, columns - x) * radius
    image = rng.normal(100, 3, (SIDE, SIDE))
    bead = np.abs(away) <= half_width
    image[bead] = (140 + 60 * np.sin(along / 1.5))[bead]
    blurred = cv2.GaussianBlur(image.astype(np.float32), (0, 0), 0.7)
    return np.asarray(np.clip(blurred, 0, 255), np.uint8), bead.astype(np.uint8)


def ring_lot(folder: Path, count: int = 20, seed: int = 0) -> Path:
    """A lot as the generator writes it; every fifth picture shows no ring."""
    rng = np.random.default_rng(seed)
    entries = []
    for name in ("frames", "masks"):
        (folder / name).mkdir(parents=True, exist_ok=True)
    for number in range(count):
        x, y = rng.uniform(110, 130, 2)
        radius = float(rng.uniform(62, 75))
        image, mask = ring_picture(rng, x=x, y=y, radius=radius)
        shows_ring = number % 5 != 4
        if not shows_ring:
            image, mask = np.asarray(rng.normal(100, 3, mask.shape), np.uint8), np.zeros_like(mask)
        frame = f"part_{number:03}.png"
        cv2.imwrite(str(folder / "frames" / frame), image)
        cv2.imwrite(str(folder / "masks" / frame), mask)
        entries.append(
            {
                "frame": frame,
                "center": [x, y] if shows_ring else None,
                "radius": radius if shows_ring else None,
                "weld": ("striped", "plain")[number % 2] if shows_ring else None,
                "sheet": ("even", "odd")[number // 2 % 2],
                "defects": [],
            }
        )
    (folder / "labels.json").write_text(json.dumps({"seed": seed, "um_per_px": 52.0, "frames": entries}))
    return folder

"""Training samples of the ring network: bands off centre, mirrored, relit, some without a ring."""

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from models.data.lot import frames, read_labels
from station.vision.polar import SECTORS, polar_band

MAX_SHIFT_PX = 14.0
"""Largest error of the coarse search, by which the bands are off centre."""


@dataclass(frozen=True, slots=True, eq=False)
class RingImage:
    """An image (H, W) uint8 with its true ring, px."""

    image: NDArray[np.uint8]
    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A band (192, 672) with the true offsets in px (84,) and presences (84,)."""

    band: NDArray[np.uint8]
    offset: NDArray[np.float32]
    presence: NDArray[np.float32]


def read_images(lot: Path) -> list[RingImage]:
    """Read the images of a lot with their true rings. Raises LearningError."""
    return [
        RingImage(image, label.center_x_px, label.center_y_px, label.radius_px)
        for label, image in frames(lot, read_labels(lot))
    ]


def sample(part: RingImage, rng: np.random.Generator) -> Sample:
    """Draw a sample of one part: off centre, mirrored and relit; some without a ring, some half hidden."""
    image, x, y, radius = part.image, part.x, part.y, part.radius
    height, width = image.shape
    if rng.random() < 0.5:
        image, x = image[:, ::-1], width - 1 - x
    if rng.random() < 0.5:
        image, y = image[::-1], height - 1 - y
    image = np.ascontiguousarray(image)
    dx, dy, dr = rng.uniform(-MAX_SHIFT_PX, MAX_SHIFT_PX, 3) / np.array([1.4, 1.4, 1.4])
    presence = np.ones(SECTORS, np.float32)
    case = rng.random()
    if case < 0.15:
        heading, away = rng.uniform(0, 2 * np.pi), rng.uniform(70, 400)
        dx, dy = away * np.cos(heading), away * np.sin(heading)
        presence[:] = 0
    elif case < 0.30:
        presence = _hide(image := image.copy(), x, y, rng)
    band = polar_band(image, x + dx, y + dy, radius + dr)
    angle = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
    along = -dx * np.cos(angle) - dy * np.sin(angle)
    across = dx * np.sin(angle) - dy * np.cos(angle)
    offset = along + np.sqrt(np.maximum(radius**2 - across**2, 0.0)) - (radius + dr)
    if rng.random() < 0.5:  # inner and outer side change places
        band, offset = np.ascontiguousarray(band[::-1]), -offset
    return Sample(_relight(band, rng), offset.astype(np.float32), presence)


def _hide(image: NDArray[np.uint8], x: float, y: float, rng: np.random.Generator) -> NDArray[np.float32]:
    """Paint over half of the image and return the presence of what is left."""
    rows, columns = np.indices(image.shape)
    heading, edge = rng.uniform(0, 2 * np.pi), rng.uniform(-250, 250)
    hidden = (columns - x) * np.cos(heading) + (rows - y) * np.sin(heading) > edge
    image[hidden] = int(rng.integers(0, 256))
    angle = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
    return np.asarray(428 * np.cos(angle - heading) <= edge, np.float32)


def _relight(band: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """Change light and lens; half of the time smooth the ripples along the weld, as on a calmer weld."""
    blurred = cv2.GaussianBlur(band, (0, 0), float(rng.uniform(0.4, 1.6))) if rng.random() < 0.4 else band
    if rng.random() < 0.5:
        calm = cv2.GaussianBlur(blurred, (0, 0), sigmaX=float(rng.uniform(2, 12)), sigmaY=0.3)
        fraction = float(rng.uniform(0.3, 1.0))
        blurred = cv2.addWeighted(calm, fraction, blurred, 1 - fraction, 0)
    gain, gamma = float(np.exp(rng.uniform(-0.7, 0.7))), float(np.exp(rng.uniform(-0.4, 0.4)))
    turned = np.linspace(0, 2 * np.pi, band.shape[1]) + rng.uniform(0, 2 * np.pi)
    light = 1 + np.cos(turned) * rng.uniform(0, 0.4)
    relit = 255 * np.clip(blurred.astype(np.float32) * gain / 255, 0, 1) ** gamma * light[None, :]
    noisy = relit + rng.standard_normal(band.shape, dtype=np.float32) * float(rng.uniform(0, 5))
    return np.asarray(np.clip(noisy, 0, 255), np.uint8)

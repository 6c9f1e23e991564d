"""Training samples: crops of rendered welds, some with something over them, and places without a weld."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from models.data.lot import LabelledFrame, frames, read_labels
from models.errors import LearningError
from models.seen.covers import Picture, cover
from models.seen.network import COLUMNS
from station.domain import NETWORK_UM_PER_PX, SEGMENT_PX, STRIP_COLUMNS, Ring
from station.files.image import read_image
from station.vision.unwrap import in_view, unwrap

BESIDE_PX = 150.0
"""Distance from the weld's circle at which the sheet alone is seen."""
BEAD_PX = 38.0
"""Half the width of the weld where a lot has no masks."""
JITTER_PX = 4.0
"""Largest error of the circle that the crops are cut with."""
CELL_PX = SEGMENT_PX // COLUMNS


@dataclass(frozen=True, slots=True, eq=False)
class Strips:
    """Strips (128, 2688) uint8 of one part: the weld, where it is (0 or 1), and the sheet beside it."""

    weld: NDArray[np.uint8]
    is_weld: NDArray[np.uint8]
    beside: tuple[NDArray[np.uint8], ...]


def read_strips(lot: Path, rng: np.random.Generator) -> list[Strips]:
    """Read the parts of a lot whose ring is wholly in view. Raises LearningError."""
    found = []
    for label, image in frames(lot, read_labels(lot)):
        height, width = image.shape
        dx, dy, dr = rng.uniform(-JITTER_PX, JITTER_PX, 3)
        ring = Ring(label.center_x_px + dx, label.center_y_px + dy, label.radius_px + dr, 1.0)
        if not in_view(ring, width, height, um_per_px=NETWORK_UM_PER_PX):
            continue
        mask = _mask(lot / "masks" / label.name, label, image.shape)
        beside = []
        for side in (-1, 1):
            other = Ring(ring.center_x_px, ring.center_y_px, ring.radius_px + side * BESIDE_PX, 1.0)
            if in_view(other, width, height, um_per_px=NETWORK_UM_PER_PX):
                beside.append(unwrap(image, other, um_per_px=NETWORK_UM_PER_PX))
        if beside:
            is_weld = (unwrap(mask, ring, um_per_px=NETWORK_UM_PER_PX) > 127).astype(np.uint8)
            found.append(Strips(unwrap(image, ring, um_per_px=NETWORK_UM_PER_PX), is_weld, tuple(beside)))
    if not found:
        raise LearningError(f"{lot}: no part has its ring and the sheet beside it in view")
    return found


def _mask(path: Path, label: LabelledFrame, shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Return where the weld is, 0 or 255: from the lot's mask, or as a ring of the usual width."""
    if path.exists():
        return np.where(read_image(path) > 0, np.uint8(255), np.uint8(0))
    rows, columns = np.indices(shape, np.float32)
    away = np.hypot(columns - label.center_x_px, rows - label.center_y_px) - label.radius_px
    return np.where(np.abs(away) < BEAD_PX, np.uint8(255), np.uint8(0))


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A crop (128, 128) uint8 with the hidden fraction of its weld (16,) and its cells (16, 16), 0 to 1."""

    crop: NDArray[np.uint8]
    hidden: NDArray[np.float32]
    covered: NDArray[np.float32]


def sample(parts: Sequence[Strips], covers: Sequence[str], rng: np.random.Generator) -> Sample:
    """Draw a sample: about half without a cover, one in eight without a weld."""
    part = parts[int(rng.integers(len(parts)))]
    place = int(rng.integers(STRIP_COLUMNS))
    cut, weld = (_cut(strip, place) for strip in (part.weld, part.is_weld))
    own = _cut(part.beside[int(rng.integers(len(part.beside)))], int(rng.integers(STRIP_COLUMNS)))
    cut, weld, own = _flipped(rng, cut, weld, own)
    picture, spare = _lens(rng, cut.astype(np.float32)), own.astype(np.float32)
    hidden = np.zeros(picture.shape, np.float32)
    case = rng.random()
    if case < 0.12:
        picture, hidden = spare, np.ones(picture.shape, np.float32)
    elif case < 0.55:
        picture, hidden = cover(rng, picture, spare, covers)
    cells = cv2.resize(hidden, (COLUMNS, COLUMNS), interpolation=cv2.INTER_AREA)
    area = weld.astype(np.float32)
    if area.sum() < 100:  # no weld here: its usual place stands for it
        area[SEGMENT_PX // 2 - int(BEAD_PX) : SEGMENT_PX // 2 + int(BEAD_PX)] = 1
    total = area.reshape(SEGMENT_PX, COLUMNS, CELL_PX).sum(axis=(0, 2))
    lost = (area * hidden).reshape(SEGMENT_PX, COLUMNS, CELL_PX).sum(axis=(0, 2))
    middle = hidden[SEGMENT_PX // 2].reshape(COLUMNS, CELL_PX).mean(axis=1)
    fraction = np.where(total > 8, lost / np.maximum(total, 1), middle)
    return Sample(_exposed(rng, picture), fraction.astype(np.float32), np.asarray(cells, np.float32))


def _cut(strip: NDArray[np.uint8], place: int) -> NDArray[np.uint8]:
    return np.take(strip, np.arange(place, place + SEGMENT_PX), axis=1, mode="wrap")


def _flipped(rng: np.random.Generator, *crops: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], ...]:
    for axis in (0, 1):
        if rng.random() < 0.5:
            crops = tuple(np.flip(crop, axis) for crop in crops)
    return tuple(np.ascontiguousarray(crop) for crop in crops)


def _lens(rng: np.random.Generator, crop: Picture) -> Picture:
    """Return the crop as another lens sees it: softer, or in coarser pixels. It can still be judged."""
    draw = rng.random()
    if draw < 0.3:
        return np.asarray(cv2.GaussianBlur(crop, (0, 0), float(rng.uniform(0.4, 1.7))), np.float32)
    if draw < 0.5:
        factor = float(rng.uniform(1.0, 4.5))
        small = cv2.resize(crop, None, fx=1 / factor, fy=1 / factor, interpolation=cv2.INTER_AREA)
        return np.asarray(cv2.resize(small, crop.shape[::-1], interpolation=cv2.INTER_CUBIC), np.float32)
    return crop


def _exposed(rng: np.random.Generator, picture: Picture) -> NDArray[np.uint8]:
    """Vary exposure, contrast and noise of the whole crop."""
    if rng.random() < 0.6:
        picture = picture * np.float32(np.exp(rng.uniform(-0.7, 0.5)))
    if rng.random() < 0.3:
        gamma = np.float32(np.exp(rng.uniform(-0.35, 0.35)))
        picture = np.asarray(255 * np.clip(picture / 255, 1e-4, 1) ** gamma, np.float32)
    if rng.random() < 0.4:
        picture = picture + rng.standard_normal(picture.shape, np.float32) * np.float32(rng.uniform(0, 5))
    return np.asarray(np.clip(np.round(picture), 0, 255), np.uint8)

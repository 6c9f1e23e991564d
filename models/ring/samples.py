"""Training samples of the ring network: moved, turned, relit and partly covered cut-outs of pictures."""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from models.ring.covers import cover
from models.ring.light import relight
from models.ring.pictures import Picture
from station.vision.marks import SPLIT

SIDE_PX = 320
"""Side of a sample."""
MAX_SCALING = 0.12
"""Largest change of size, as a logarithm."""
FAR_PX = 150
"""Largest distance of the middle of a sample from that of its picture, so that borders cut rings."""
JOINT_WEIGHT = 4.0
"""How many times more often a picture is drawn that shows a bare joint only, of which there are few."""
BLIND_PX = 29
"""Side of an area, wider than any bead, in which nothing is seen if it is all white or all black."""
WHITE_DN, BLACK_DN = 254, 1
"""Grey levels from which, and up to which, a pixel counts as white and as black."""

Field = NDArray[np.float32]


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """A cut-out with the truth about its parts of cells."""

    image: NDArray[np.uint8]
    """Cut-out (320, 320) uint8."""
    coverage: Field
    """Covered fractions (2, 160, 160) of bead and bare joint."""


def chances(pictures: Sequence[Picture]) -> NDArray[np.float64]:
    """Return the probability of each picture to be drawn: higher, the more of the ring is a bare joint."""
    areas = np.array([picture.masks.sum(axis=(0, 1), dtype=np.float64) for picture in pictures])
    weights = 1 + JOINT_WEIGHT * areas[:, 1] / (areas.sum(axis=1) + 1)
    return np.asarray(weights / weights.sum())


def sample(pictures: Sequence[Picture], chance: NDArray[np.float64], rng: np.random.Generator) -> Sample:
    """Draw a sample of one of the pictures, each of which has its own chance."""
    first, second = rng.choice(len(pictures), 2, p=chance)
    image, masks = _cut(pictures[first], rng)
    if rng.random() < 0.4:
        other, other_masks = _cut(pictures[second], rng)
        cover(image, masks, other=other, other_masks=other_masks, rng=rng)
    relit = relight(image, rng)
    masks[_blind(relit)] = 0
    size = (SIDE_PX // SPLIT, SIDE_PX // SPLIT)
    parts = cv2.resize(masks.astype(np.float32) / 255, size, interpolation=cv2.INTER_AREA)
    return Sample(relit, np.ascontiguousarray(parts.transpose(2, 0, 1)))


def _blind(image: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """Return where an image (N, N) is white or black over more than the width of a bead: nothing is seen."""
    lost = ((image >= WHITE_DN) | (image <= BLACK_DN)).astype(np.uint8)
    wide = np.ones((BLIND_PX, BLIND_PX), np.uint8)
    return np.asarray(cv2.morphologyEx(lost, cv2.MORPH_OPEN, wide) > 0)


def _cut(picture: Picture, rng: np.random.Generator) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return a cut-out (320, 320) and the masks (320, 320, 2) of bead and joint, 0 to 255."""
    height, width = picture.image.shape
    turn = float(rng.integers(4)) * np.pi / 2 if rng.random() < 0.6 else float(rng.uniform(0, 2 * np.pi))
    scaling = np.exp(rng.uniform(-MAX_SCALING, MAX_SCALING)) if rng.random() < 0.7 else 1.0
    mirror = -1.0 if rng.random() < 0.5 else 1.0
    cos, sin = np.cos(turn) * scaling, np.sin(turn) * scaling
    matrix = np.array([[cos * mirror, -sin], [sin * mirror, cos]])
    far = rng.uniform(-FAR_PX, FAR_PX, 2) * rng.uniform(0, 1)
    middle = np.array([(SIDE_PX - 1) / 2, (SIDE_PX - 1) / 2]) + far
    move = middle - matrix @ np.array([(width - 1) / 2, (height - 1) / 2])
    whole = np.column_stack([matrix, move])
    border = cv2.BORDER_REFLECT_101 if rng.random() < 0.5 else cv2.BORDER_CONSTANT
    value = float(rng.choice([0.0, 255.0, picture.image.mean(), rng.uniform(0, 255)]))
    size = (SIDE_PX, SIDE_PX)
    image = cv2.warpAffine(
        picture.image, whole, size, flags=cv2.INTER_LINEAR, borderMode=border, borderValue=value
    )
    moved = cv2.warpAffine(
        picture.masks, whole, size, flags=cv2.INTER_LINEAR, borderMode=border, borderValue=0
    )
    return np.asarray(image, np.uint8), np.asarray(moved, np.uint8)

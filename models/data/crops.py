"""Labelled crops in memory: what every training and evaluation starts from, wherever the images come from."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from station.classify.extent import CELL_PX, CELLS
from station.classify.onnx import CLASSES, MAPPED

OK = 0
"""Label of a crop without a defect; the label of a kind of defect is its place in `CLASSES`."""
IGNORED = -1
"""Label of a crop that a defect just touches: neither OK nor NOK."""
DEFECTS = range(1, len(CLASSES))
"""Labels of the kinds of defect, the graver later."""
CHANNELS = tuple(kind.name for kind in MAPPED)
"""Kinds of defect of the maps' channels."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Crops:
    """N crops with their labels."""

    images: NDArray[np.uint8]
    """(N, 128, 128)"""
    labels: NDArray[np.int64]
    """OK, or the place of a kind of defect in `CLASSES` (N,)."""
    maps: NDArray[np.uint8]
    """How much of each cell of 4 x 4 px a defect covers, 0..255 (N, C, 32, 32); channels as in `CHANNELS`."""
    mapped: NDArray[np.bool_]
    """True for each crop whose map is known (N,)."""
    parts: NDArray[np.str_]
    """Name of each crop's part (N,): no part may be on both sides of a split."""
    names: NDArray[np.str_]
    """Name of each crop in reports (N,)."""

    def __len__(self) -> int:
        return len(self.labels)

    def pick(self, chosen: NDArray[np.int64] | NDArray[np.bool_]) -> "Crops":
        """Return some of the crops, or some of them more than once."""
        return Crops(**{name: getattr(self, name)[chosen] for name in self.__slots__})

    def count(self, label: int) -> int:
        """Return the number of crops with that label."""
        return int((self.labels == label).sum())


def join(sets: Sequence[Crops]) -> Crops:
    """Return the crops of several sets as one."""
    return Crops(
        **{name: np.concatenate([getattr(crops, name) for crops in sets]) for name in Crops.__slots__}
    )


def coarse(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return how much of each cell (32, 32) a mask (128, 128) covers, 0 to 255."""
    cells = mask.reshape(CELLS, CELL_PX, CELLS, CELL_PX).mean(axis=(1, 3))
    return np.asarray(np.rint(cells * 255), np.uint8)


def only(crops: Crops, kinds: Sequence[int]) -> Crops:
    """Return the OK crops and those whose label is one of `kinds`."""
    return crops.pick(np.isin(crops.labels, [OK, *kinds]))


def empty_maps(count: int) -> NDArray[np.uint8]:
    """Return the maps of crops without a defect."""
    return np.zeros((count, len(CHANNELS), CELLS, CELLS), np.uint8)

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
"""A crop that a defect just touches: neither OK nor NOK."""
DEFECTS = range(1, len(CLASSES))
"""Labels of the kinds of defect, the graver later."""
CHANNELS = tuple(kind.name for kind in MAPPED)
"""Kinds of defect of the maps' channels."""


@dataclass(frozen=True, slots=True, eq=False)
class Crops:
    """N crops: images (N, 128, 128) uint8 with labels (N,) int64: OK, or the place of a kind of defect in `CLASSES`.

    `maps` (N, C, 32, 32) uint8 says how much of each cell of 4 x 4 px a defect covers, 0 to 255, one channel for each of the C kinds
    in `CHANNELS`; it means nothing where `mapped` (N,) is False. `parts` (N,) names the part of each crop: no part may be on both
    sides of a split.
    """

    images: NDArray[np.uint8]
    labels: NDArray[np.int64]
    maps: NDArray[np.uint8]
    mapped: NDArray[np.bool_]
    parts: NDArray[np.str_]
    names: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.labels)

    def pick(self, chosen: NDArray[np.int64] | NDArray[np.bool_]) -> "Crops":
        """Some of the crops, or some more than once."""
        return Crops(*(getattr(self, name)[chosen] for name in self.__slots__))

    def count(self, label: int) -> int:
        """Number of crops with that label."""
        return int((self.labels == label).sum())


def join(sets: Sequence[Crops]) -> Crops:
    """All crops of several sets."""
    return Crops(*(np.concatenate([getattr(s, name) for s in sets]) for name in Crops.__slots__))


def coarse(mask: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Share of each cell (32, 32) that a mask (128, 128) covers, 0 to 255."""
    cells = mask.reshape(CELLS, CELL_PX, CELLS, CELL_PX).mean(axis=(1, 3))
    return np.asarray(np.rint(cells * 255), np.uint8)


def only(crops: Crops, kinds: Sequence[int]) -> Crops:
    """OK crops and those with a defect of `kinds`."""
    return crops.pick(np.isin(crops.labels, [OK, *kinds]))


def empty_maps(count: int) -> NDArray[np.uint8]:
    """Maps of crops without a defect."""
    return np.zeros((count, len(CHANNELS), CELLS, CELLS), np.uint8)

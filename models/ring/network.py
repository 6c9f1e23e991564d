"""The ring network: how much of each cell of a picture is bead and how much is bare joint."""

import torch
from torch import Tensor, nn
from torch.nn import functional

from models.classifier.network import Conv, Mix
from station.vision.marks import CELL_PX, CHANNELS, SPLIT

POOL_PX = 2 * CELL_PX
"""Side in px of the areas over which grey levels are averaged first."""
AREAS = 9
"""Number of areas along each side of the surroundings to which a place is compared: 3.7 mm."""
NOISE_DN2 = 2.0
"""Variance of grey levels that is added, so that an even surface does not become all noise."""


class _Stem(nn.Module):
    """First filters, of grey levels less their local mean, divided by their local deviation.

    The filters see raw grey levels; mean and deviation, which hardly change within a filter, are applied to
    their results, at a sixteenth of the cost.
    """

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.filters = nn.Conv2d(1, outputs, 2 * CELL_PX, CELL_PX, bias=False)
        self.bias = nn.Parameter(torch.zeros(1, outputs, 1, 1))

    def forward(self, picture: Tensor) -> Tensor:
        """Return (K, C, H / 4, W / 4) of grey levels (K, 1, H, W).

        Always in float32: eight bits of mantissa lose a small contrast on a bright surface.
        """
        with torch.autocast("cpu", enabled=False):
            mean = _surroundings(picture)
            variance = (_surroundings(picture * picture) - mean * mean).clamp(min=0)
            gain = 1 / torch.sqrt(variance + NOISE_DN2)
            sums = self.filters.weight.sum((1, 2, 3))[None, :, None, None]
            wide = functional.pad(picture, (CELL_PX // 2,) * 4, mode="replicate")
            answer: Tensor = self.filters(wide) * _twice(gain) - _twice(mean * gain) * sums
            return functional.relu(answer + self.bias)


class RingNet(nn.Module):
    """The network: pictures (K, 1, H, W) uint8 at 52 µm/px to covered fractions (K, 8, H / 4, W / 4).

    H and W are multiples of 16. The eight values of a cell are those of `station.vision.marks`.
    """

    def __init__(self) -> None:
        super().__init__()
        self.quarter = _Stem(16)
        self.eighth = nn.Sequential(Conv(16, 48, 2, 2), Mix(48, 3))
        self.sixteenth = nn.Sequential(Conv(48, 96, 2, 2), Mix(96, 5), Mix(96, 5), Mix(96, 5))
        self.down_eighth = nn.Conv2d(96, 48, 1)
        self.join_eighth = Mix(48, 3)
        self.down_quarter = nn.Conv2d(48, 16, 1)
        self.join_quarter = Mix(16, 3)
        self.marks = nn.Conv2d(16, CHANNELS, 1)

    def forward(self, pictures: Tensor) -> Tensor:
        """Return the logits of the covered fractions."""
        quarter = self.quarter(pictures.to(torch.float32))
        eighth = self.eighth(quarter)
        coarse = self.down_eighth(self.sixteenth(eighth))
        eighth = self.join_eighth(functional.relu(_twice(coarse) + eighth))
        quarter = self.join_quarter(functional.relu(_twice(self.down_quarter(eighth)) + quarter))
        answer: Tensor = self.marks(quarter)
        return answer


def cells_of(parts: Tensor) -> Tensor:
    """Return (K, 2 * 4, H, W) of parts of cells (K, 2, 2 H, 2 W), in the order of the network's channels."""
    return functional.pixel_unshuffle(parts, SPLIT)


def _surroundings(x: Tensor) -> Tensor:
    """Return the mean (K, 1, H / 8, W / 8) over the surroundings of each area."""
    pooled = functional.avg_pool2d(x, POOL_PX)
    return functional.avg_pool2d(pooled, AREAS, 1, AREAS // 2, count_include_pad=False)


def _twice(x: Tensor) -> Tensor:
    return functional.interpolate(x, scale_factor=2.0, mode="nearest")

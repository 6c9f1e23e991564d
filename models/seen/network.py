"""The network: how much of the weld is hidden, in each of 16 columns of a crop."""

import torch
from torch import Tensor, nn
from torch.nn import functional

COLUMNS = 16
"""Columns of a crop for which the network answers, 8 px wide each."""


def _conv(inputs: int, outputs: int, size: int, stride: int) -> nn.Sequential:
    padding = (size - stride) // 2
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, size, stride, padding, bias=False), nn.BatchNorm2d(outputs), nn.ReLU()
    )


class _Mix(nn.Module):
    """A residual block: `size` x `size` within each channel, then 1 x 1 across the channels."""

    def __init__(self, channels: int, size: int) -> None:
        super().__init__()
        self.own = nn.Conv2d(channels, channels, size, padding=size // 2, groups=channels)
        self.across = _conv(channels, channels, 1, 1)

    def forward(self, x: Tensor) -> Tensor:
        """Return a tensor of the same shape."""
        answer: Tensor = x + self.across(self.own(x))
        return answer


class SeenNet(nn.Module):
    """The network: crops (K, 1, 128, 128) uint8 to hidden fractions of the weld (K, 16), as logits."""

    def __init__(self) -> None:
        super().__init__()
        self.fine = nn.Sequential(_conv(2, 32, 4, 4), _Mix(32, 3))
        self.coarse = nn.Sequential(_conv(32, 48, 2, 2), _Mix(48, 5), _Mix(48, 5), _Mix(48, 5))
        self.covered = nn.Conv2d(48, 1, 1)
        self.hidden = nn.Sequential(
            nn.Conv1d(97, 48, 3, padding=1), nn.ReLU(), nn.Conv1d(48, 1, 3, padding=1)
        )

    def forward(self, crops: Tensor) -> tuple[Tensor, Tensor]:
        """Return logits of the hidden fraction (K, 16) and of covered cells (K, 16, 16)."""
        x = crops.to(torch.float32)
        centred = x - x.mean(dim=(2, 3), keepdim=True)
        spread = torch.sqrt((centred * centred).mean(dim=(2, 3), keepdim=True))
        features = self.coarse(self.fine(torch.cat([x / 128 - 1, centred / (spread + 4.0)], dim=1)))
        covered = self.covered(features)
        pooled = torch.cat([features.mean(dim=2), features.amax(dim=2), covered.mean(dim=2)], dim=1)
        return self.hidden(pooled)[:, 0], covered[:, 0]


def loss(answer: tuple[Tensor, Tensor], hidden: Tensor, covered: Tensor) -> Tensor:
    """Return the loss against the true fractions (K, 16) and (K, 16, 16)."""
    columns, cells = answer
    of_columns = functional.binary_cross_entropy_with_logits(columns, hidden)
    return of_columns + 0.5 * functional.binary_cross_entropy_with_logits(cells, covered)

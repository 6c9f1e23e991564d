"""The classifier's network, normalisation included.

Takes uint8 crops; returns class logits, a coarse defect map and appearance features.
"""

import torch
from torch import Tensor, nn
from torch.nn import functional

from station.classify.onnx import CLASSES, MAPPED

FEATURES = 160
"""Length of the pooled vector from which the classes are decided."""
STATISTICS = 2 * (32 + 64)
"""Number of appearance features: mean and standard deviation of each fine channel."""


def channels_last(network: nn.Module) -> None:
    """Store the weights so that convolutions take half the time on a CPU."""
    network.to(memory_format=torch.channels_last)  # type: ignore[call-overload]


class Conv(nn.Sequential):
    """Convolution, batch norm, ReLU: the runtime fuses the three."""

    def __init__(self, inputs: int, outputs: int, size: int = 1, stride: int = 1) -> None:
        super().__init__(
            nn.Conv2d(inputs, outputs, size, stride, (size - stride + 1) // 2, bias=False),
            nn.BatchNorm2d(outputs),
            nn.ReLU(inplace=True),
        )


class Mix(nn.Module):
    """Residual block: a filter per channel over its neighbourhood, then 1 x 1 across the channels."""

    def __init__(self, channels: int, size: int) -> None:
        super().__init__()
        self.branch = nn.Sequential(
            nn.Conv2d(channels, channels, size, padding=size // 2, groups=channels), Conv(channels, channels)
        )

    def forward(self, x: Tensor) -> Tensor:
        """Return a tensor of the same shape."""
        answer: Tensor = x + self.branch(x)
        return answer


class _Up(nn.Module):
    """Doubles the resolution of a coarse map and adds a fine one."""

    def __init__(self, coarse: int, fine: int, outputs: int) -> None:
        super().__init__()
        self.coarse, self.fine = nn.Conv2d(coarse, outputs, 1), nn.Conv2d(fine, outputs, 1, bias=False)

    def forward(self, coarse: Tensor, fine: Tensor) -> Tensor:
        """Join (K, coarse, H, W) and (K, fine, 2H, 2W) to (K, outputs, 2H, 2W)."""
        wide = functional.interpolate(self.coarse(coarse), scale_factor=2.0, mode="nearest")
        return functional.relu(wide + self.fine(fine))


class WeldNet(nn.Module):
    """The network: down to 8 x 8, back up to 32 x 32 for the map.

    The classes are decided from both ends and from the strongest point of the map. One network classifies and
    locates, so that verdict and map come from the same features.
    """

    def __init__(self, classes: int = len(CLASSES), channels: int = len(MAPPED)) -> None:
        super().__init__()
        self.quarter = nn.Sequential(Conv(1, 32, 8, 4), Mix(32, 3))
        self.eighth = nn.Sequential(Conv(32, 64, 2, 2), Mix(64, 5), Mix(64, 5))
        self.sixteenth = nn.Sequential(Conv(64, 128, 2, 2), Mix(128, 3), Mix(128, 3))
        self.up_eighth = _Up(128, 64, 48)
        self.up_quarter = _Up(48, 32, 32)
        self.fine = Mix(32, 3)
        self.map = nn.Conv2d(32, channels, 1)
        self.feature = nn.Sequential(nn.Linear(2 * 128 + 2 * 32, FEATURES), nn.ReLU())
        self.classes = nn.Sequential(nn.Dropout(0.2), nn.Linear(FEATURES + channels, classes))

    def forward(self, crops: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Judge crops (K, 1, 128, 128) uint8, each brought to mean 0 and standard deviation 1.

        Returns class logits (K, classes), map logits (K, channels, 32, 32) and appearance features (K, 192).
        """
        x = crops.to(torch.float32)
        centred = x - x.mean(dim=(2, 3), keepdim=True)
        spread = torch.sqrt((centred * centred).mean(dim=(2, 3), keepdim=True))
        quarter = self.quarter(centred / (spread + 2.0))
        eighth = self.eighth(quarter)
        sixteenth = self.sixteenth(eighth)
        fine = self.fine(self.up_quarter(self.up_eighth(sixteenth, eighth), quarter))
        where = self.map(fine)
        ends = [
            sixteenth.mean(dim=(2, 3)),
            sixteenth.amax(dim=(2, 3)),
            fine.mean(dim=(2, 3)),
            fine.amax(dim=(2, 3)),
        ]
        features = self.feature(torch.cat(ends, dim=1))
        logits = self.classes(torch.cat([features, where.amax(dim=(2, 3))], dim=1))
        return logits, where, torch.cat([_statistics(quarter), _statistics(eighth)], dim=1)


def _statistics(x: Tensor) -> Tensor:
    """Return mean and standard deviation of each channel, (K, 2 C)."""
    mean = x.mean(dim=(2, 3))
    return torch.cat([mean, torch.sqrt((x * x).mean(dim=(2, 3)) - mean * mean + 1e-4)], dim=1)

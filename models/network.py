"""The classifier network, normalisation included: uint8 crops in, class logits out."""

import torch
from torch import Tensor, nn


def _block(inputs: int, outputs: int) -> nn.Sequential:
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride=2, padding=1, bias=False),
        nn.BatchNorm2d(outputs),
        nn.SiLU(),
        nn.Conv2d(outputs, outputs, 3, padding=1, groups=outputs, bias=False),
        nn.Conv2d(outputs, outputs, 1, bias=False),
        nn.BatchNorm2d(outputs),
        nn.SiLU(),
    )


class WeldNet(nn.Module):
    """Four strided blocks, then the mean and the maximum over the crop: a small hole counts as much as a wide gap."""

    def __init__(self) -> None:
        super().__init__()
        self.features = nn.Sequential(_block(1, 24), _block(24, 48), _block(48, 96), _block(96, 128))
        self.head = nn.Sequential(nn.Dropout(0.2), nn.Linear(256, 3))

    def forward(self, crops: Tensor) -> Tensor:
        """Logits (K, 3) of crops (K, 1, 128, 128) uint8; each crop is brought to mean 0 and standard deviation 1."""
        x = crops.to(torch.float32)
        centred = x - x.mean(dim=(2, 3), keepdim=True)
        spread = torch.sqrt((centred * centred).mean(dim=(2, 3), keepdim=True))
        maps = self.features(centred / (spread + 2.0))
        pooled = torch.cat([maps.mean(dim=(2, 3)), maps.amax(dim=(2, 3))], dim=1)
        logits: Tensor = self.head(pooled)
        return logits


class Probabilities(nn.Module):
    """The network as shipped: probabilities instead of logits."""

    def __init__(self, network: WeldNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, crops: Tensor) -> Tensor:
        """Probabilities (K, 3) of crops (K, 1, 128, 128) uint8."""
        return torch.softmax(self.network(crops), dim=1)

"""The ring network: where the weld's centre line is in a flattened band, and whether there is one."""

import torch
from torch import Tensor, nn

from station.vision.polar import ROWS

BIN_PX = 4


class _Wrap(nn.Module):
    """A convolution that is periodic along the columns."""

    def __init__(
        self, inputs: int, outputs: int, *, size: int, stride: tuple[int, int], dilation: int = 1
    ) -> None:
        super().__init__()
        self.reach = size // 2
        rows = (size // 2) * dilation
        self.conv = nn.Conv2d(
            inputs, outputs, size, stride, padding=(rows, 0), dilation=(dilation, 1), bias=False
        )
        self.norm = nn.BatchNorm2d(outputs)

    def forward(self, x: Tensor) -> Tensor:
        """Convolve (K, C, H, W) to (K, C', H', W')."""
        wrapped = torch.cat([x[..., -self.reach :], x, x[..., : self.reach]], dim=3)
        answer: Tensor = nn.functional.silu(self.norm(self.conv(wrapped)))
        return answer


class RingNet(nn.Module):
    """The network: bands (K, 1, 192, 672) uint8 to offset (px) and presence (0..1) by sector, (K, 2, 84)."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = nn.Sequential(_Wrap(1, 16, size=5, stride=(2, 4)), _Wrap(16, 32, size=3, stride=(2, 2)))
        self.body = nn.ModuleList([_Wrap(32, 32, size=3, stride=(1, 1), dilation=d) for d in (1, 2, 4, 2, 1)])
        self.where = nn.Conv2d(32, 1, 1)
        self.there = nn.Linear(32, 1)
        places = (torch.arange(ROWS // BIN_PX, dtype=torch.float32) + 0.5) * BIN_PX - ROWS / 2
        self.places_px: Tensor
        self.register_buffer("places_px", places[None, :, None])

    def forward(self, bands: Tensor) -> Tensor:
        """Find offsets (outwards positive, from the middle of the band) and presences."""
        x = bands.to(torch.float32)
        centred = x - x.mean(dim=(2, 3), keepdim=True)
        x = self.stem(centred / (torch.sqrt((centred * centred).mean(dim=(2, 3), keepdim=True)) + 2.0))
        for block in self.body:
            x = x + block(x)
        weight = torch.softmax(self.where(x)[:, 0], dim=1)
        offset = (weight * self.places_px).sum(dim=1)
        pooled = (x * weight[:, None]).sum(dim=2)
        presence = torch.sigmoid(self.there(pooled.transpose(1, 2))[..., 0])
        return torch.stack([offset, presence], dim=1)

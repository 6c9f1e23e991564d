"""The paper's classifier (section 5: YOLOv11n-cls), written after the published architecture.

1.5 million weights, three channels, cross-stage blocks, one attention block. It is the yardstick for time and
accuracy and has no defect map.
"""

import torch
from torch import Tensor, nn


class _Conv(nn.Sequential):
    def __init__(
        self,
        inputs: int,
        outputs: int,
        size: int = 1,
        stride: int = 1,
        *,
        groups: int = 1,
        active: bool = True,
    ) -> None:
        super().__init__(
            nn.Conv2d(inputs, outputs, size, stride, size // 2, groups=groups, bias=False),
            nn.BatchNorm2d(outputs),
            nn.SiLU() if active else nn.Identity(),
        )


class _Bottleneck(nn.Module):
    def __init__(self, channels: int, inner: int) -> None:
        super().__init__()
        self.branch = nn.Sequential(_Conv(channels, inner, 3), _Conv(inner, channels, 3))

    def forward(self, x: Tensor) -> Tensor:
        """Return a tensor of the same shape."""
        answer: Tensor = x + self.branch(x)
        return answer


class _Stage(nn.Module):
    """Passes half of the channels through `body`, half around it, and mixes all of them at the end."""

    def __init__(self, inputs: int, outputs: int, hidden: int, body: nn.Module) -> None:
        super().__init__()
        self.first = _Conv(inputs, 2 * hidden)
        self.body = body
        self.last = _Conv(3 * hidden, outputs)

    def forward(self, x: Tensor) -> Tensor:
        """Take (K, inputs, H, W) to (K, outputs, H, W)."""
        a, b = self.first(x).chunk(2, dim=1)
        answer: Tensor = self.last(torch.cat([a, b, self.body(b)], dim=1))
        return answer


class _Deep(nn.Module):
    """Two bottlenecks with a bypass around both."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        half = channels // 2
        self.through, self.beside = _Conv(channels, half), _Conv(channels, half)
        self.body = nn.Sequential(_Bottleneck(half, half), _Bottleneck(half, half))
        self.last = _Conv(channels, channels)

    def forward(self, x: Tensor) -> Tensor:
        """Return a tensor of the same shape."""
        answer: Tensor = self.last(torch.cat([self.body(self.through(x)), self.beside(x)], dim=1))
        return answer


class _Attention(nn.Module):
    """Attention of each place to all others, then a feed-forward block."""

    def __init__(self, channels: int, heads: int) -> None:
        super().__init__()
        self.heads, self.value = heads, channels // heads
        self.key = self.value // 2
        self.project = _Conv(channels, channels + 2 * heads * self.key, active=False)
        self.place = _Conv(channels, channels, 3, groups=channels, active=False)
        self.mix = _Conv(channels, channels, active=False)
        self.feed = nn.Sequential(_Conv(channels, 2 * channels), _Conv(2 * channels, channels, active=False))

    def forward(self, x: Tensor) -> Tensor:
        """Return a tensor of the same shape."""
        count, channels, height, width = x.shape
        parts = self.project(x).view(count, self.heads, 2 * self.key + self.value, height * width)
        query, key, value = parts.split([self.key, self.key, self.value], dim=2)
        weight = torch.softmax(query.transpose(2, 3) @ key * self.key**-0.5, dim=3)
        seen = (value @ weight.transpose(2, 3)).reshape(count, channels, height, width)
        x = x + self.mix(seen + self.place(value.reshape(count, channels, height, width)))
        answer: Tensor = x + self.feed(x)
        return answer


class PaperNet(nn.Module):
    """The network: crops (K, 1, 128, 128) uint8 to logits (K, `classes`).

    The channel is repeated three times, as the published network takes it.
    """

    def __init__(self, classes: int = 2) -> None:
        super().__init__()
        self.features = nn.Sequential(
            _Conv(3, 16, 3, 2),
            _Conv(16, 32, 3, 2),
            _Stage(32, 64, 16, _Bottleneck(16, 8)),
            _Conv(64, 64, 3, 2),
            _Stage(64, 128, 32, _Bottleneck(32, 16)),
            _Conv(128, 128, 3, 2),
            _Stage(128, 128, 64, _Deep(64)),
            _Conv(128, 256, 3, 2),
            _Stage(256, 256, 128, _Deep(128)),
            _Stage(256, 256, 128, _Attention(128, 2)),
            _Conv(256, 1280),
        )
        self.classes = nn.Linear(1280, classes)

    def forward(self, crops: Tensor) -> tuple[Tensor, None, None]:
        """Return class logits; neither map nor features."""
        x = (crops.to(torch.float32) / 255).expand(-1, 3, -1, -1)
        return self.classes(self.features(x).mean(dim=(2, 3))), None, None

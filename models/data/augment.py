"""Random changes to training crops that keep their labels true: place, light, surface, lens and sensor.

They work on whole batches, in torch.
"""

import torch
from torch import Tensor
from torch.nn import functional


def augment(images: Tensor, maps: Tensor, rng: torch.Generator) -> tuple[Tensor, Tensor]:
    """Return changed copies of images (K, 1, 128, 128), 0..255, and of their maps (K, C, 32, 32), 0..1."""
    images, maps = _move(images, maps, rng)
    images = _light(_stain(images, rng), rng)
    return _expose(_blur(images, rng), rng), maps


def _uniform(low: float, high: float, shape: tuple[int, ...], rng: torch.Generator) -> Tensor:
    return torch.rand(shape, generator=rng) * (high - low) + low


def _sometimes(fraction: float, count: int, rng: torch.Generator) -> Tensor:
    """Return 1 for about this fraction of the crops and 0 for the others, (K, 1, 1, 1)."""
    return (torch.rand((count, 1, 1, 1), generator=rng) < fraction).float()


def _move(images: Tensor, maps: Tensor, rng: torch.Generator) -> tuple[Tensor, Tensor]:
    """Mirror (rows: joined parts swapped, columns: direction), stretch, shear and shift by a few pixels."""
    count = len(images)
    theta = torch.zeros(count, 2, 3)
    for axis, (stretch, shift) in enumerate(((0.15, 0.08), (0.10, 0.10))):
        mirror = torch.randint(0, 2, (count,), generator=rng).float() * 2 - 1
        theta[:, axis, axis] = torch.exp(_uniform(-stretch, stretch, (count,), rng)) * mirror
        theta[:, axis, 2] = _uniform(-shift, shift, (count,), rng)
    theta[:, 0, 1] = _uniform(-0.12, 0.12, (count,), rng)

    def moved(x: Tensor) -> Tensor:
        grid = functional.affine_grid(theta, [count, 1, *x.shape[2:]], align_corners=False)
        return functional.grid_sample(
            x, grid, mode="bilinear", padding_mode="reflection", align_corners=False
        )

    return moved(images), moved(maps)


def _smooth(points: tuple[int, int], count: int, rng: torch.Generator) -> Tensor:
    """Return smooth noise (K, 1, 128, 128) through a grid of random points, standard deviation about 1."""
    rough = torch.randn((count, 1, *points), generator=rng)
    medium = functional.interpolate(rough, size=(32, 32), mode="bicubic", align_corners=True)
    return functional.interpolate(medium, scale_factor=4.0, mode="bilinear")


def _stain(images: Tensor, rng: torch.Generator) -> Tensor:
    """Add soft dark or bright patches that keep the texture, like soot, oxide and stains: not defects."""
    count = len(images)
    edge = _uniform(2, 10, (count, 1, 1, 1), rng)
    level = _uniform(0.3, 1.6, (count, 1, 1, 1), rng)
    coarse, fine = _smooth((5, 5), count, rng), _smooth((12, 12), count, rng)
    patch = torch.sigmoid((coarse + 0.4 * fine - level) * edge)
    depth = _uniform(-0.55, 0.3, (count, 1, 1, 1), rng) * _sometimes(0.35, count, rng)
    return images * (1 + depth * patch)


def _light(images: Tensor, rng: torch.Generator) -> Tensor:
    """Vary the light over the crop, and the brightness of bead and joined parts against each other."""
    count = len(images)
    over = _smooth((3, 3), count, rng) * _uniform(0, 0.25, (count, 1, 1, 1), rng)
    across = _smooth((6, 2), count, rng).mean(dim=3, keepdim=True) * _uniform(0, 0.35, (count, 1, 1, 1), rng)
    return images * torch.exp(over + across * _sometimes(0.5, count, rng))


def _blur(images: Tensor, rng: torch.Generator) -> Tensor:
    """Blur a third of the crops, Gaussian of 0.3 to 1.6 px."""
    count = len(images)
    sigma = _uniform(0.3, 1.6, (count, 1), rng) * _sometimes(0.33, count, rng)[:, :, 0, 0] + 0.05
    at = torch.arange(-5, 6, dtype=torch.float32)
    kernel = torch.exp(-0.5 * (at / sigma) ** 2)
    kernel = (kernel / kernel.sum(dim=1, keepdim=True))[:, None, None, :]
    flat = functional.pad(images.reshape(1, count, 128, 128), (5, 5, 5, 5), mode="reflect")
    flat = functional.conv2d(
        functional.conv2d(flat, kernel, groups=count), kernel.transpose(2, 3), groups=count
    )
    return flat.reshape(count, 1, 128, 128)


def _expose(images: Tensor, rng: torch.Generator) -> Tensor:
    """Apply gain with clipping, gamma and noise one and two pixels wide; round to whole grey levels."""
    count = len(images)
    gain = torch.exp(_uniform(-0.7, 0.6, (count, 1, 1, 1), rng))
    gamma = torch.exp(_uniform(-0.4, 0.4, (count, 1, 1, 1), rng))
    images = 255 * (images * gain / 255).clamp(1e-4, 1) ** gamma
    fine = torch.randn(images.shape, generator=rng)
    wide = functional.interpolate(
        torch.randn((count, 1, 64, 64), generator=rng), scale_factor=2.0, mode="nearest"
    )
    noise = fine * _uniform(0, 5, (count, 1, 1, 1), rng) + wide * _uniform(
        0, 4, (count, 1, 1, 1), rng
    ) * _sometimes(0.3, count, rng)
    return (images + noise * _sometimes(0.5, count, rng)).round().clamp(0, 255)

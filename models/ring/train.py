"""The ring network: where the weld's centre line runs in a flattened band, and where there is one at all.

Trained on rendered parts with bands cut off centre by as much as the coarse search may be wrong.
"""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import cv2
import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from models.classifier.network import channels_last
from models.data.labelled import read_images
from station.vision.polar import ROWS, SECTORS, polar_band

BIN_PX = 4
MAX_SHIFT_PX = 14.0


class _Wrap(nn.Module):
    """A convolution that is periodic along the columns."""

    def __init__(
        self, inputs: int, outputs: int, size: int, stride: tuple[int, int], dilation: int = 1
    ) -> None:
        super().__init__()
        self.reach = size // 2
        rows = (size // 2) * dilation
        self.conv = nn.Conv2d(
            inputs, outputs, size, stride, padding=(rows, 0), dilation=(dilation, 1), bias=False
        )
        self.norm = nn.BatchNorm2d(outputs)

    def forward(self, x: Tensor) -> Tensor:
        """(K, C, H, W) to (K, C', H', W')."""
        wrapped = torch.cat([x[..., -self.reach :], x, x[..., : self.reach]], dim=3)
        answer: Tensor = nn.functional.silu(self.norm(self.conv(wrapped)))
        return answer


class RingNet(nn.Module):
    """Bands (K, 1, 192, 672) uint8 to offset in px and presence 0..1 of each sector, (K, 2, 84)."""

    def __init__(self) -> None:
        super().__init__()
        self.stem = nn.Sequential(_Wrap(1, 16, 5, (2, 4)), _Wrap(16, 32, 3, (2, 2)))
        self.body = nn.ModuleList([_Wrap(32, 32, 3, (1, 1), d) for d in (1, 2, 4, 2, 1)])
        self.where = nn.Conv2d(32, 1, 1)
        self.there = nn.Linear(32, 1)
        places = (torch.arange(ROWS // BIN_PX, dtype=torch.float32) + 0.5) * BIN_PX - ROWS / 2
        self.places_px: Tensor
        self.register_buffer("places_px", places[None, :, None])

    def forward(self, bands: Tensor) -> Tensor:
        """Offsets are outwards positive, from the middle of the band."""
        x = bands.to(torch.float32)
        centred = x - x.mean(dim=(2, 3), keepdim=True)
        x = self.stem(centred / (torch.sqrt((centred * centred).mean(dim=(2, 3), keepdim=True)) + 2.0))
        for block in self.body:
            x = x + block(x)
        share = torch.softmax(self.where(x)[:, 0], dim=1)
        offset = (share * self.places_px).sum(dim=1)
        pooled = (x * share[:, None]).sum(dim=2)
        presence = torch.sigmoid(self.there(pooled.transpose(1, 2))[..., 0])
        return torch.stack([offset, presence], dim=1)


@dataclass(frozen=True, slots=True)
class RingPlan:
    """How to train."""

    steps: int = 1500
    batch: int = 16
    learning_rate: float = 0.003
    seed: int = 0


def train_ring(lots: list[Path], plan: RingPlan, report: Callable[[str], None]) -> tuple[RingNet, float]:
    """Train on all but the last tenth of the parts; the network and its median centre error on those, px."""
    rng = np.random.default_rng(plan.seed)
    torch.manual_seed(plan.seed)
    parts = [part for lot in lots for part in read_images(lot)]
    held = max(1, len(parts) // 10)
    training, kept = parts[:-held], parts[-held:]
    network = RingNet()
    channels_last(network)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=0.01)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, plan.learning_rate, total_steps=plan.steps)
    running = 0.0
    for step in range(1, plan.steps + 1):
        samples = [_sample(training[int(rng.integers(len(training)))], rng) for _ in range(plan.batch)]
        bands = torch.from_numpy(np.stack([s[0] for s in samples])[:, None])
        offset = torch.from_numpy(np.stack([s[1] for s in samples]))
        there = torch.from_numpy(np.stack([s[2] for s in samples]))
        network.train()
        loss = _loss(network(bands), offset, there)
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        schedule.step()
        running += float(loss.detach())
        if step % 100 == 0:
            report(
                f"step {step}/{plan.steps}: loss {running / 100:.3f}, held out circle error {_error_px(network, kept):.2f} px"
            )
            running = 0.0
    return network, _error_px(network, kept)


def ring_card(version: str, data_hash: str, plan: RingPlan, error_px: float) -> str:
    """What the file is, for people."""
    card = {
        "version": version,
        "data_hash": data_hash,
        "held_out_center_error_px_median": round(error_px, 2),
        "plan": asdict(plan),
    }
    return (
        "# Ring network\n\nWritten by the training run. Rendered images only; the error is that of one pass on bands cut 5 px off centre,\n"
        f"on rendered parts held out from training.\n\n```json\n{json.dumps(card, indent=2)}\n```\n"
    )


def _loss(answer: Tensor, offset: Tensor, there: Tensor) -> Tensor:
    sector = nn.functional.smooth_l1_loss(answer[:, 0], offset, reduction="none") * there
    presence = nn.functional.binary_cross_entropy(answer[:, 1].clamp(1e-6, 1 - 1e-6), there)
    whole = there.mean(dim=1) > 0.9
    circle = (_fit(answer[:, 0], there) - _fit(offset, there)).abs().sum(dim=1)[whole]
    return sector.sum() / there.sum().clamp(min=1) + presence + (circle.mean() if len(circle) else 0.0)


def _fit(offset: Tensor, weight: Tensor) -> Tensor:
    """(dr, dx, dy) by weighted least squares, (K, 3)."""
    angle = (torch.arange(SECTORS) + 0.5) * (2 * torch.pi / SECTORS)
    basis = torch.stack([torch.ones(SECTORS), torch.cos(angle), torch.sin(angle)], dim=1)
    normal = torch.einsum("ks,si,sj->kij", weight + 1e-3, basis, basis)
    fit: Tensor = torch.linalg.solve(normal, torch.einsum("ks,si,ks->ki", weight + 1e-3, basis, offset))
    return fit


def _sample(
    part: tuple[NDArray[np.uint8], float, float, float], rng: np.random.Generator
) -> tuple[NDArray[np.uint8], NDArray[np.float32], NDArray[np.float32]]:
    """Band, offsets (84,) and presence (84,): off centre, mirrored, relit; some without a ring, some half hidden."""
    image, x, y, radius = part
    height, width = image.shape
    if rng.random() < 0.5:
        image, x = image[:, ::-1], width - 1 - x
    if rng.random() < 0.5:
        image, y = image[::-1], height - 1 - y
    image = np.ascontiguousarray(image)
    dx, dy, dr = rng.uniform(-MAX_SHIFT_PX, MAX_SHIFT_PX, 3) / np.array([1.4, 1.4, 1.4])
    there = np.ones(SECTORS, np.float32)
    kind = rng.random()
    if kind < 0.15:
        heading, away = rng.uniform(0, 2 * np.pi), rng.uniform(70, 400)
        dx, dy = away * np.cos(heading), away * np.sin(heading)
        there[:] = 0
    elif kind < 0.30:
        there = _hide(image := image.copy(), x, y, rng)
    band = polar_band(image, x + dx, y + dy, radius + dr)
    angle = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
    along, across = -dx * np.cos(angle) - dy * np.sin(angle), dx * np.sin(angle) - dy * np.cos(angle)
    offset = along + np.sqrt(np.maximum(radius**2 - across**2, 0.0)) - (radius + dr)
    if rng.random() < 0.5:  # the partners change places
        band, offset = np.ascontiguousarray(band[::-1]), -offset
    return _relight(band, rng), offset.astype(np.float32), there


def _hide(image: NDArray[np.uint8], x: float, y: float, rng: np.random.Generator) -> NDArray[np.float32]:
    """Paint over half the picture; presence of what is left."""
    rows, columns = np.indices(image.shape)
    heading, edge = rng.uniform(0, 2 * np.pi), rng.uniform(-250, 250)
    hidden = (columns - x) * np.cos(heading) + (rows - y) * np.sin(heading) > edge
    image[hidden] = int(rng.integers(0, 256))
    angle = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
    return np.asarray(428 * np.cos(angle - heading) <= edge, np.float32)


def _relight(band: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    """Another light and lens; half the time part of the ripples smoothed away along the weld, as on a calmer weld."""
    blurred = cv2.GaussianBlur(band, (0, 0), float(rng.uniform(0.4, 1.6))) if rng.random() < 0.4 else band
    if rng.random() < 0.5:
        calm = cv2.GaussianBlur(blurred, (0, 0), sigmaX=float(rng.uniform(2, 12)), sigmaY=0.3)
        share = float(rng.uniform(0.3, 1.0))
        blurred = cv2.addWeighted(calm, share, blurred, 1 - share, 0)
    gain, gamma = float(np.exp(rng.uniform(-0.7, 0.7))), float(np.exp(rng.uniform(-0.4, 0.4)))
    turn = 1 + np.cos(np.linspace(0, 2 * np.pi, band.shape[1]) + rng.uniform(0, 2 * np.pi)) * rng.uniform(
        0, 0.4
    )
    relit = 255 * np.clip(blurred.astype(np.float32) * gain / 255, 0, 1) ** gamma * turn[None, :]
    noisy = relit + rng.standard_normal(band.shape, dtype=np.float32) * float(rng.uniform(0, 5))
    return np.asarray(np.clip(noisy, 0, 255), np.uint8)


def _error_px(network: RingNet, parts: list[tuple[NDArray[np.uint8], float, float, float]]) -> float:
    """Median centre error after one pass, bands cut 5 px off centre."""
    network.eval()
    bands = np.stack([polar_band(image, x + 4, y - 3, r + 2) for image, x, y, r in parts])[:, None]
    with torch.no_grad():
        answer = network(torch.from_numpy(bands))
        fit = _fit(answer[:, 0], answer[:, 1])
    return float(torch.median(torch.hypot(fit[:, 1] + 4, fit[:, 2] - 3)))

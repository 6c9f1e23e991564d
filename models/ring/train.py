"""Training of the ring network on rendered parts."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from models.classifier.network import channels_last
from models.ring.network import RingNet
from models.ring.samples import RingImage, read_images, sample
from station.vision.polar import SECTORS, polar_band


@dataclass(frozen=True, slots=True)
class RingPlan:
    """How to train."""

    steps: int = 1500
    batch: int = 16
    learning_rate: float = 0.003
    seed: int = 0


def train_ring(lots: Sequence[Path], plan: RingPlan, report: Callable[[str], None]) -> tuple[RingNet, float]:
    """Train on all parts but the last tenth; return the network and its median centre error on those, px."""
    rng = np.random.default_rng(plan.seed)
    torch.manual_seed(plan.seed)
    parts = [part for lot in lots for part in read_images(lot)]
    held = max(1, len(parts) // 10)
    training, held_out = parts[:-held], parts[-held:]
    network = RingNet()
    channels_last(network)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=0.01)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, plan.learning_rate, total_steps=plan.steps)
    running = 0.0
    for step in range(1, plan.steps + 1):
        samples = [sample(training[int(rng.integers(len(training)))], rng) for _ in range(plan.batch)]
        bands = torch.from_numpy(np.stack([s.band for s in samples])[:, None])
        offset = torch.from_numpy(np.stack([s.offset for s in samples]))
        presence = torch.from_numpy(np.stack([s.presence for s in samples]))
        network.train()
        loss = _loss(network(bands), offset, presence)
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        schedule.step()
        running += float(loss.detach())
        if step % 100 == 0:
            error = f"held-out centre error {_error_px(network, held_out):.2f} px"
            report(f"step {step}/{plan.steps}: loss {running / 100:.3f}, {error}")
            running = 0.0
    return network, _error_px(network, held_out)


def ring_card(version: str, data_hash: str, plan: RingPlan, error_px: float) -> str:
    """Return the text of RING.md."""
    card = {
        "version": version,
        "data_hash": data_hash,
        "held_out_center_error_px_median": round(error_px, 2),
        "plan": asdict(plan),
    }
    return (
        "# Ring network\n\nWritten by the training run. It has seen rendered images only. The error\n"
        "is that of one pass over bands cut 5 px off centre, on rendered parts not used for training.\n\n"
        f"```json\n{json.dumps(card, indent=2)}\n```\n"
    )


def _loss(answer: Tensor, offset: Tensor, presence: Tensor) -> Tensor:
    sector = nn.functional.smooth_l1_loss(answer[:, 0], offset, reduction="none") * presence
    seen = nn.functional.binary_cross_entropy(answer[:, 1].clamp(1e-6, 1 - 1e-6), presence)
    whole = presence.mean(dim=1) > 0.9
    circle = (_fit(answer[:, 0], presence) - _fit(offset, presence)).abs().sum(dim=1)[whole]
    return sector.sum() / presence.sum().clamp(min=1) + seen + (circle.mean() if len(circle) else 0.0)


def _fit(offset: Tensor, weight: Tensor) -> Tensor:
    """Fit (dr, dx, dy) by weighted least squares, (K, 3)."""
    angle = (torch.arange(SECTORS) + 0.5) * (2 * torch.pi / SECTORS)
    basis = torch.stack([torch.ones(SECTORS), torch.cos(angle), torch.sin(angle)], dim=1)
    normal = torch.einsum("ks,si,sj->kij", weight + 1e-3, basis, basis)
    fit: Tensor = torch.linalg.solve(normal, torch.einsum("ks,si,ks->ki", weight + 1e-3, basis, offset))
    return fit


def _error_px(network: RingNet, parts: Sequence[RingImage]) -> float:
    """Return the median centre error after one pass over bands cut 5 px off centre."""
    network.eval()
    bands = np.stack([polar_band(p.image, p.x + 4, p.y - 3, p.radius + 2) for p in parts])[:, None]
    with torch.no_grad():
        answer = network(torch.from_numpy(bands))
        fit = _fit(answer[:, 0], answer[:, 1])
    return float(torch.median(torch.hypot(fit[:, 1] + 4, fit[:, 2] - 3)))

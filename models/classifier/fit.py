"""The training loop: crops in, a trained network out."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from models.classifier.network import WeldNet, channels_last
from models.data.augment import augment
from models.data.crops import DEFECTS, OK, Crops
from station.defects import KINDS

Report = Callable[[str], None]
Trained = TypeVar("Trained", bound=nn.Module)
MIN_LEFT = 0.3
"""A crop whose defect was moved out of the picture but for this share teaches nothing."""


def batch_shares() -> tuple[float, ...]:
    """Return half OK, and half by how frequent each kind of defect is on a line."""
    fractions = [kind.line_fraction for kind in KINDS]
    return 0.5, *(fraction / (2 * sum(fractions)) for fraction in fractions)


@dataclass(frozen=True, slots=True)
class Plan:
    """How to train."""

    steps: int = 5000
    batch: int = 64
    learning_rate: float = 0.003
    weight_decay: float = 0.02
    shares: tuple[float, ...] = batch_shares()
    """Shares of OK and of each kind of defect in a batch, in the order of `CLASSES`."""
    map_weight: float = 4.0
    smoothing: float = 0.02
    average: float = 0.998
    """Share of the old weights in the moving average that is kept as the result."""
    hardness: float = 0.25
    """How much oftener a crop is drawn the larger its last loss was, 0: all alike."""
    unseen_loss: float | None = 1.4
    """Rendered defects with a larger mean loss at half time are left out from then on: lost in dark or blur, they teach only false
    alarms. 1.4: held for OK with more than 75 %. None: none, for what a person has labelled can be seen."""
    seed: int = 0


def fit(network: Trained, crops: Crops, plan: Plan, report: Report) -> Trained:
    """Train `network` on `crops`; returns the moving average of its weights, ready to judge."""
    drawn = np.random.default_rng(plan.seed)
    rng = torch.Generator().manual_seed(plan.seed)
    images, maps = torch.from_numpy(crops.images), torch.from_numpy(crops.maps)
    labels, mapped = torch.from_numpy(crops.labels), torch.from_numpy(crops.mapped)
    pools = [np.flatnonzero(crops.labels == kind) for kind in (OK, *DEFECTS)]
    lost = np.full(len(crops), 1.0)
    averaging = get_ema_multi_avg_fn(plan.average)  # type: ignore[no-untyped-call]
    average = AveragedModel(network, multi_avg_fn=averaging, use_buffers=True)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=plan.weight_decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, plan.learning_rate, total_steps=plan.steps, pct_start=0.15
    )
    every = max(1, plan.steps // 20)
    half = bool(torch.ops.mkldnn._is_mkldnn_bf16_supported())  # noqa: SLF001 - where the CPU has it, two thirds of the time
    running: list[float] = []
    network.train()
    channels_last(network)
    for step in range(1, plan.steps + 1):
        if step == plan.steps // 2 and plan.unseen_loss is not None:
            pools = [
                pool if kind == OK else _visible(pool, lost, plan.unseen_loss)
                for kind, pool in enumerate(pools)
            ]
        chosen = torch.from_numpy(_draw(pools, lost, plan, drawn))
        wanted = maps[chosen].float() / 255
        seen, moved = augment(images[chosen][:, None].float(), wanted, rng)
        before, after = wanted.sum(dim=(1, 2, 3)), moved.sum(dim=(1, 2, 3))
        kept = (after >= MIN_LEFT * before) | ~mapped[chosen]
        with torch.autocast("cpu", torch.bfloat16, enabled=half):
            answer = network(seen)
        loss, each = _loss(answer, labels[chosen], moved, mapped[chosen], kept, plan)
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(network.parameters(), 2.0)
        optimizer.step()
        schedule.step()
        average.update_parameters(network)
        lost[chosen.numpy()] = 0.5 * lost[chosen.numpy()] + 0.5 * each.numpy()
        running.append(float(loss.detach()))
        if step % every == 0:
            report(f"step {step}/{plan.steps}: loss {np.mean(running[-every:]):.3f}")
    average.module.eval()
    return cast("Trained", average.module)


def _visible(pool: NDArray[np.int64], lost: NDArray[np.float64], unseen_loss: float) -> NDArray[np.int64]:
    """Without the crops that half of the training could not learn, unless these are most of them."""
    seen = pool[lost[pool] < unseen_loss]
    return seen if seen.size > pool.size // 2 else pool


def _draw(
    pools: list[NDArray[np.int64]], lost: NDArray[np.float64], plan: Plan, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Crops of one batch: the kinds by their shares, of each kind the hard ones oftener."""
    kinds = rng.choice(len(pools), plan.batch, p=plan.shares)
    chosen = []
    for kind in sorted(set(kinds.tolist())):
        weight = (lost[pools[kind]] + 0.05) ** plan.hardness
        chosen.append(rng.choice(pools[kind], int((kinds == kind).sum()), p=weight / weight.sum()))
    return np.concatenate(chosen)


def _loss(
    answer: tuple[Tensor, Tensor | None, Tensor | None],
    labels: Tensor,
    maps: Tensor,
    mapped: Tensor,
    kept: Tensor,
    plan: Plan,
) -> tuple[Tensor, Tensor]:
    """Mean loss, and the classes' loss of each crop (K,)."""
    logits, where = answer[0].float(), answer[1]
    each = functional.cross_entropy(logits, labels, reduction="none", label_smoothing=plan.smoothing) * kept
    if where is None:
        return each.mean(), each.detach()
    cells = (
        functional.binary_cross_entropy_with_logits(where.float(), maps, reduction="none").mean(dim=(1, 2, 3))
        * mapped
    )
    return each.mean() + plan.map_weight * cells.mean(), each.detach()


def predict(network: WeldNet, images: NDArray[np.uint8]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Probabilities (N, classes) and statistics (N, 192) of images (N, 128, 128) uint8."""
    network.eval()
    with torch.no_grad():
        answers = [network(chunk[:, None]) for chunk in torch.split(torch.from_numpy(images), 128)]
    scores = torch.cat([torch.softmax(logits, dim=1) for logits, _, _ in answers])
    return np.asarray(scores.numpy(), np.float64), np.asarray(
        torch.cat([f for _, _, f in answers]).numpy(), np.float64
    )

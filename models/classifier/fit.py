"""The training loop: crops in, a trained network out."""

from collections.abc import Callable
from typing import TypeVar, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn
from torch.nn import functional
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from models.classifier.network import WeldNet, channels_last
from models.classifier.plan import Plan
from models.data.augment import augment
from models.data.crops import DEFECTS, OK, Crops
from models.errors import LearningError
from station.classify.onnx import CLASSES

Report = Callable[[str], None]
"""Receives each line about a training run's progress."""
Trained = TypeVar("Trained", bound=nn.Module)
MIN_LEFT = 0.3
"""Fraction of a defect that must be left in a crop that was moved; with less it teaches nothing."""


def fit(network: Trained, crops: Crops, plan: Plan, report: Report) -> Trained:
    """Train `network` on `crops` and return the moving average of its weights, ready to judge.

    Raises LearningError if the plan draws a kind that no crop shows, or leaves out one that crops show.
    """
    drawn = np.random.default_rng(plan.seed)
    rng = torch.Generator().manual_seed(plan.seed)
    images, maps = torch.from_numpy(crops.images), torch.from_numpy(crops.maps)
    labels, mapped = torch.from_numpy(crops.labels), torch.from_numpy(crops.mapped)
    pools = _pools(crops, plan)
    last_loss = np.full(len(crops), 1.0)
    averaging = get_ema_multi_avg_fn(plan.average)  # type: ignore[no-untyped-call]
    average = AveragedModel(network, multi_avg_fn=averaging, use_buffers=True)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=plan.weight_decay)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer, plan.learning_rate, total_steps=plan.steps, pct_start=0.15
    )
    every = max(1, plan.steps // 20)
    # bfloat16 takes two thirds of the time where the CPU has it
    half = bool(torch.ops.mkldnn._is_mkldnn_bf16_supported())  # noqa: SLF001
    running: list[float] = []
    network.train()
    channels_last(network)
    for step in range(1, plan.steps + 1):
        if step == plan.steps // 2 and plan.unseen_loss is not None:
            pools = [
                pool if label == OK else _visible(pool, last_loss, plan.unseen_loss)
                for label, pool in enumerate(pools)
            ]
        chosen = torch.from_numpy(_draw(pools, last_loss, plan, drawn))
        truth = maps[chosen].float() / 255
        seen, moved = augment(images[chosen][:, None].float(), truth, rng)
        before, after = truth.sum(dim=(1, 2, 3)), moved.sum(dim=(1, 2, 3))
        kept = (after >= MIN_LEFT * before) | ~mapped[chosen]
        with torch.autocast("cpu", torch.bfloat16, enabled=half):
            answer = network(seen)
        loss, each = _loss(
            answer, labels=labels[chosen], maps=moved, mapped=mapped[chosen], kept=kept, plan=plan
        )
        optimizer.zero_grad()
        loss.backward()  # type: ignore[no-untyped-call]
        nn.utils.clip_grad_norm_(network.parameters(), 2.0)
        optimizer.step()
        schedule.step()
        average.update_parameters(network)
        last_loss[chosen.numpy()] = 0.5 * last_loss[chosen.numpy()] + 0.5 * each.numpy()
        running.append(float(loss.detach()))
        if step % every == 0:
            report(f"step {step}/{plan.steps}: loss {np.mean(running[-every:]):.3f}")
    average.module.eval()
    return cast("Trained", average.module)


def _pools(crops: Crops, plan: Plan) -> list[NDArray[np.int64]]:
    """Return the places of the OK crops and of those of each kind of defect."""
    pools = [np.flatnonzero(crops.labels == label) for label in (OK, *DEFECTS)]
    for label, (pool, fraction) in enumerate(zip(pools, plan.shares, strict=True)):
        if (pool.size > 0) != (fraction > 0):
            found = f"{pool.size} crops show {CLASSES[label]}, but its fraction of a batch is {fraction:g}"
            raise LearningError(f"{found}. Choose other kinds, or other data")
    return pools


def _visible(
    pool: NDArray[np.int64], last_loss: NDArray[np.float64], unseen_loss: float
) -> NDArray[np.int64]:
    """Return the crops that half of the training could learn, or all of them if these are only a few."""
    seen = pool[last_loss[pool] < unseen_loss]
    return seen if seen.size > pool.size // 2 else pool


def _draw(
    pools: list[NDArray[np.int64]], last_loss: NDArray[np.float64], plan: Plan, rng: np.random.Generator
) -> NDArray[np.int64]:
    """Draw the crops of one batch: the kinds by their fractions, of each kind the hard ones more often."""
    labels = rng.choice(len(pools), plan.batch, p=plan.shares)
    chosen = []
    for label in sorted(set(labels.tolist())):
        weight = (last_loss[pools[label]] + 0.05) ** plan.hardness
        chosen.append(rng.choice(pools[label], int((labels == label).sum()), p=weight / weight.sum()))
    return np.concatenate(chosen)


def _loss(
    answer: tuple[Tensor, Tensor | None, Tensor | None],
    *,
    labels: Tensor,
    maps: Tensor,
    mapped: Tensor,
    kept: Tensor,
    plan: Plan,
) -> tuple[Tensor, Tensor]:
    """Return the mean loss, and the classes' loss of each crop (K,)."""
    logits, where = answer[0].float(), answer[1]
    each = functional.cross_entropy(logits, labels, reduction="none", label_smoothing=plan.smoothing) * kept
    if where is None:
        return each.mean(), each.detach()
    cells = functional.binary_cross_entropy_with_logits(where.float(), maps, reduction="none")
    return each.mean() + plan.map_weight * (cells.mean(dim=(1, 2, 3)) * mapped).mean(), each.detach()


def predict(network: WeldNet, images: NDArray[np.uint8]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return probabilities (N, classes) and appearance features (N, 192) of images (N, 128, 128) uint8."""
    network.eval()
    with torch.no_grad():
        answers = [network(chunk[:, None]) for chunk in torch.split(torch.from_numpy(images), 128)]
    scores = torch.cat([torch.softmax(logits, dim=1) for logits, _, _ in answers])
    features = torch.cat([features for _, _, features in answers])
    return np.asarray(scores.numpy(), np.float64), np.asarray(features.numpy(), np.float64)

"""Training of the network that says what is hidden, and how well it does on covers it has not been shown."""

import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from models.classifier.network import channels_last
from models.errors import LearningError
from models.seen.covers import COVERS
from models.seen.network import SeenNet, loss
from models.seen.samples import Sample, Strips, read_strips, sample

HELD_OUT = 8
"""One part in so many is held out."""
JUDGED = 512
"""Samples by which a network is judged, for each cover."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SeenPlan:
    """How to train."""

    steps: int = 3000
    batch: int = 48
    learning_rate: float = 0.004
    seed: int = 0
    leave_out: tuple[str, ...] = ()
    """Covers that the training does not show."""


def train_seen(
    lots: Sequence[Path], plan: SeenPlan, report: Callable[[str], None]
) -> tuple[SeenNet, dict[str, float]]:
    """Train; return the network and, per cover, the fraction of hidden columns that it recognises.

    The fractions are of parts that were held out; "nothing" is the fraction of visible columns that it takes
    for hidden. Raises LearningError if a cover is unknown.
    """
    unknown = sorted(set(plan.leave_out) - set(COVERS))
    if unknown:
        raise LearningError(f"unknown cover {unknown[0]}; known: {', '.join(COVERS)}")
    rng = np.random.default_rng(plan.seed)
    torch.manual_seed(plan.seed)
    strips = [part for lot in lots for part in read_strips(lot, rng)]
    held_out = strips[::HELD_OUT]
    training = [part for index, part in enumerate(strips) if index % HELD_OUT]
    covers = [name for name in COVERS if name not in plan.leave_out]
    network = SeenNet()
    channels_last(network)
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=0.02)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, plan.learning_rate, total_steps=plan.steps)
    running = 0.0
    network.train()
    for step in range(1, plan.steps + 1):
        crops, hidden, covered = _batch([sample(training, covers, rng) for _ in range(plan.batch)])
        value = loss(network(crops), hidden, covered)
        optimizer.zero_grad()
        value.backward()  # type: ignore[no-untyped-call]
        optimizer.step()
        schedule.step()
        running += float(value.detach())
        if step % 100 == 0:
            report(f"step {step}/{plan.steps}: loss {running / 100:.4f}")
            running = 0.0
    return network.eval(), recognised(network, held_out, seed=plan.seed + 1)


def recognised(network: SeenNet, parts: Sequence[Strips], *, seed: int) -> dict[str, float]:
    """Return the fraction of hidden columns found at a limit of 0.5, per cover; see `train_seen`."""
    network.eval()
    found: dict[str, float] = {}
    clear = []
    for name in COVERS:
        rng = np.random.default_rng([seed, len(found)])
        crops, hidden, _ = _batch([sample(parts, (name,), rng) for _ in range(JUDGED)])
        with torch.no_grad():
            answer = torch.sigmoid(network(crops)[0])
        whole = hidden > 0.9
        found[name] = round(float((answer[whole] > 0.5).float().mean()), 4)
        clear.append((answer[hidden == 0] > 0.5).float().mean())
    return {**found, "nothing": round(float(torch.stack(clear).mean()), 5)}


def seen_card(version: str, data_hash: str, plan: SeenPlan, found: dict[str, float]) -> str:
    """Return the text of SEEN.md."""
    card = {"version": version, "data_hash": data_hash, "plan": asdict(plan), "held_out_parts": found}
    return (
        "# Network that says what is hidden\n\n"
        "Written by the training run. It has seen rendered images only.\n"
        "Per cover: the fraction of hidden columns that it recognises on parts that were held out;\n"
        '"nothing": the fraction of visible columns that it takes for hidden.\n\n'
        f"```json\n{json.dumps(card, indent=2)}\n```\n"
    )


def _batch(samples: Sequence[Sample]) -> tuple[Tensor, Tensor, Tensor]:
    crops = torch.from_numpy(np.stack([one.crop for one in samples])[:, None])
    hidden = torch.from_numpy(np.stack([one.hidden for one in samples]))
    return crops, hidden, torch.from_numpy(np.stack([one.covered for one in samples]))

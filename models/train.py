"""One training run: rendered lot in, released ONNX file and its card out."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from models.augment import augment
from models.data import HOLE, IGNORED, MISSING, OK, LabelledStrip, data_hash, read_lot, split_by_part
from models.errors import LearningError
from models.export import export
from models.network import WeldNet
from station.domain import SEGMENT_PX, STRIP_COLUMNS

Report = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Plan:
    """How to train."""

    epochs: int = 14
    crops_per_epoch: int = 6000
    batch: int = 48
    learning_rate: float = 0.002
    jitters: int = 2
    held_out: float = 0.15
    seed: int = 0


def train(lots: list[Path], out: Path, version: str, plan: Plan, report: Report) -> dict[str, object]:
    """Train on `lots`, write `out`/weldgate.onnx and `out`/CARD.md; returns the figures of the card."""
    rng = np.random.default_rng(plan.seed)
    torch.manual_seed(plan.seed)
    strips = [strip for lot in lots for strip in read_lot(lot, plan.jitters, rng)]
    training, held = split_by_part(strips, plan.held_out)
    held = held[:: 1 + plan.jitters]
    if len({s.part for s in training}) < 2 or not held:
        raise LearningError(f"{', '.join(map(str, lots))}: too few parts to train and to hold some out")
    pools = _pools(training)
    network = WeldNet()
    optimizer = torch.optim.AdamW(network.parameters(), lr=plan.learning_rate, weight_decay=0.01)
    steps = plan.epochs * (plan.crops_per_epoch // plan.batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, plan.learning_rate, total_steps=steps)
    loss_of = nn.CrossEntropyLoss(label_smoothing=0.02)
    crops, labels = _grid(held)
    for epoch in range(plan.epochs):
        network.train()
        total = 0.0
        for _ in range(plan.crops_per_epoch // plan.batch):
            x, y = _batch(training, pools, plan.batch, rng)
            optimizer.zero_grad()
            loss = loss_of(network(x), y)
            loss.backward()
            optimizer.step()
            schedule.step()
            total += float(loss.detach())
        figures = _figures(_predict(network, crops), labels, 0.5, 0.5)
        report(f"epoch {epoch + 1}/{plan.epochs}: loss {total * plan.batch / plan.crops_per_epoch:.3f}, held out F2 {figures['f2']:.3f}")
    scores = _predict(network, crops)
    hole, gone = _thresholds(scores, labels)
    digest = data_hash(lots)
    out.mkdir(parents=True, exist_ok=True)
    export(network, out / "weldgate.onnx", version, digest, hole, gone)
    card: dict[str, object] = {
        "version": version,
        "data_hash": digest,
        "parts": len({s.part for s in strips}),
        "held_out_parts": len(held),
        "held_out_crops": int((labels != IGNORED).sum()),
        "weights": sum(p.numel() for p in network.parameters()),
        "thresholds": {"hole": hole, "missing_weld": gone},
        "held_out": _figures(scores, labels, hole, gone),
        "plan": asdict(plan),
    }
    (out / "CARD.md").write_text(_card_text(card))
    return card


def _pools(strips: list[LabelledStrip]) -> dict[int, NDArray[np.int64]]:
    """For each class the (strip, column) pairs, a column every 16 px, (K, 2)."""
    pools: dict[int, list[tuple[int, int]]] = {OK: [], HOLE: [], MISSING: []}
    for index, strip in enumerate(strips):
        for column in range(0, STRIP_COLUMNS, 16):
            label = strip.crop(column)[1]
            if label != IGNORED:
                pools[label].append((index, column))
    short = [name for name, key in (("OK", OK), ("hole", HOLE), ("missing weld", MISSING)) if not pools[key]]
    if short:
        raise LearningError(f"the training parts show no crop of {', '.join(short)}; render more parts")
    return {key: np.array(pairs) for key, pairs in pools.items()}


def _batch(
    strips: list[LabelledStrip], pools: dict[int, NDArray[np.int64]], size: int, rng: np.random.Generator
) -> tuple[torch.Tensor, torch.Tensor]:
    crops, labels = [], []
    for label in rng.choice([OK, HOLE, MISSING], size, p=[0.45, 0.35, 0.2]):
        index, column = pools[int(label)][rng.integers(len(pools[int(label)]))]
        crops.append(augment(strips[index].crop(int(column))[0], rng))
        labels.append(int(label))
    return torch.from_numpy(np.stack(crops)[:, None]), torch.tensor(labels)


def _grid(strips: list[LabelledStrip]) -> tuple[torch.Tensor, NDArray[np.int64]]:
    """The crops as the station cuts them, and their labels."""
    pairs = [strip.crop(column) for strip in strips for column in range(0, STRIP_COLUMNS, SEGMENT_PX)]
    return torch.from_numpy(np.stack([c for c, _ in pairs])[:, None]), np.array([label for _, label in pairs])


def _predict(network: WeldNet, crops: torch.Tensor) -> NDArray[np.float64]:
    network.eval()
    with torch.no_grad():
        parts = [torch.softmax(network(chunk), dim=1) for chunk in torch.split(crops, 128)]
    return np.asarray(torch.cat(parts).numpy(), np.float64)


def _figures(scores: NDArray[np.float64], labels: NDArray[np.int64], hole: float, gone: float) -> dict[str, float]:
    """Precision, recall and F2 of NOK (paper, eqs. 6 to 8)."""
    judged = labels != IGNORED
    nok = ((scores[:, HOLE] >= hole) | (scores[:, MISSING] >= gone) | (scores[:, OK] <= scores[:, 1:].max(axis=1)))[judged]
    true = labels[judged] != OK
    tp, fp, fn = int((nok & true).sum()), int((nok & ~true).sum()), int((~nok & true).sum())
    precision, recall = tp / max(tp + fp, 1), tp / max(tp + fn, 1)
    f2 = 5 * precision * recall / max(4 * precision + recall, 1e-9)
    return {"precision": precision, "recall": recall, "f2": f2, "tp": tp, "fp": fp, "fn": fn}


def _thresholds(scores: NDArray[np.float64], labels: NDArray[np.int64]) -> tuple[float, float]:
    """Thresholds with the best F2 on the held-out parts; of equals the lowest, since an escape costs more."""
    grid = np.round(np.arange(0.1, 0.95, 0.05), 2)
    best = max(
        ((_figures(scores, labels, h, m)["f2"], -h - m, h, m) for h in grid for m in grid),
        key=lambda row: (round(row[0], 4), row[1]),
    )
    return float(best[2]), float(best[3])


def _card_text(card: dict[str, object]) -> str:
    return (
        "# Model card\n\nWritten by the training run. The network has seen rendered images only; the figures below are on rendered\n"
        "parts held out from training, crops as the station cuts them. They say nothing of a real line: measure there\n"
        "before release.\n\n"
        f"```json\n{json.dumps(card, indent=2)}\n```\n"
    )

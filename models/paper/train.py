"""The paper's classifier trained as it stands there (section 7): OK against NOK, Adam with 0.0005, batches of 30, images unchanged.

The number of epochs is not given; 15 is enough for the loss to settle on 5000 images.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from models.classifier.export import write_onnx
from models.classifier.fit import Report
from models.classifier.network import channels_last
from models.data.crops import OK, Crops
from models.data.rendered import read_rendered
from models.evaluation.measures import count
from models.paper.network import PaperNet
from station.classify.onnx import Network

BATCH = 256


@dataclass(frozen=True, slots=True)
class PaperPlan:
    """Section 7 of the paper."""

    epochs: int = 15
    batch: int = 30
    learning_rate: float = 0.0005
    seed: int = 0


class _Binary(nn.Module):
    def __init__(self, network: PaperNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, crops: Tensor) -> Tensor:
        """Probabilities (K, 2) of OK and NOK."""
        return torch.softmax(self.network(crops)[0], dim=1)


def train_paper(folders: Sequence[Path], out: Path, plan: PaperPlan, report: Report) -> dict[str, Any]:
    """Train on rendered datasets; writes paper.onnx and run.json into `out`, figures at threshold 0.5 through the file."""
    training, held, digest = read_rendered(folders)
    torch.manual_seed(plan.seed)
    rng = np.random.default_rng(plan.seed)
    network = PaperNet(2)
    start = perf_counter()
    _fit(network, training, plan, rng, report)
    out.mkdir(parents=True, exist_ok=True)
    crops = torch.zeros((21, 1, 128, 128), dtype=torch.uint8)
    part = write_onnx(
        _Binary(network.eval()),
        crops,
        out / "paper.onnx",
        "crops",
        ("probabilities",),
        {"weldgate.classes": '["ok", "nok"]'},
    )
    part.replace(out / "paper.onnx")
    found = count(paper_scores(out / "paper.onnx", held.images) >= 0.5, held.labels != OK)
    card = {
        "protocol": "paper",
        "data_hash": digest,
        "training_crops": len(training),
        "held_out": {**asdict(found), "precision": found.precision, "recall": found.recall, "f2": found.f2},
        "weights": sum(p.numel() for p in network.parameters()),
        "seconds": perf_counter() - start,
        "plan": asdict(plan),
    }
    (out / "run.json").write_text(json.dumps(card, indent=1) + "\n")
    return card


def paper_scores(path: Path, images: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Probability of NOK (N,) of crops (N, 128, 128) through a file of this protocol. Raises ModelError."""
    network = Network(path)
    chunks = [
        network.run(("probabilities",), {"crops": images[i : i + BATCH, None]})[0]
        for i in range(0, len(images), BATCH)
    ]
    return np.asarray(np.concatenate(chunks)[:, 1], np.float64)


def _fit(network: PaperNet, crops: Crops, plan: PaperPlan, rng: np.random.Generator, report: Report) -> None:
    images, labels = torch.from_numpy(crops.images), torch.from_numpy((crops.labels != OK).astype(np.int64))
    optimizer = torch.optim.Adam(network.parameters(), lr=plan.learning_rate)
    network.train()
    channels_last(network)
    for epoch in range(1, plan.epochs + 1):
        losses = []
        for chosen in torch.split(torch.from_numpy(rng.permutation(len(crops))), plan.batch):
            if len(chosen) < 2:
                continue
            optimizer.zero_grad()
            loss = nn.functional.cross_entropy(network(images[chosen][:, None])[0], labels[chosen])
            loss.backward()  # type: ignore[no-untyped-call]
            optimizer.step()
            losses.append(float(loss.detach()))
        report(f"epoch {epoch}/{plan.epochs}: loss {np.mean(losses):.3f}")

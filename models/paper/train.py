"""The paper's classifier trained as the paper says (section 7).

OK against NOK, Adam with a learning rate of 0.0005, batches of 30, images unchanged. The number of epochs is
not given; after 15 the loss has settled on 5000 images.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from models.classifier.card import Decisions
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
    """How to train, by section 7 of the paper."""

    epochs: int = 15
    batch: int = 30
    learning_rate: float = 0.0005
    seed: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperCard:
    """Facts of a training run of the paper's classifier. The names of the fields are those in run.json."""

    protocol: str
    data_hash: str
    """SHA-256 of the images."""
    training_crops: int
    held_out: Decisions
    weights: int
    seconds: float
    """Training time."""
    plan: PaperPlan


class _Binary(nn.Module):
    def __init__(self, network: PaperNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, crops: Tensor) -> Tensor:
        """Return the probabilities (K, 2) of OK and NOK."""
        return torch.softmax(self.network(crops)[0], dim=1)


def train_paper(folders: Sequence[Path], out: Path, plan: PaperPlan, report: Report) -> PaperCard:
    """Train on rendered datasets; the figures are those of the file at a threshold of 0.5.

    Writes paper.onnx and run.json into `out` and returns the card. Raises LearningError.
    """
    training, held_out, digest = read_rendered(folders, ())
    torch.manual_seed(plan.seed)
    rng = np.random.default_rng(plan.seed)
    network = PaperNet(2)
    start = perf_counter()
    _fit(network, training, plan, rng, report=report)
    out.mkdir(parents=True, exist_ok=True)
    crops = torch.zeros((21, 1, 128, 128), dtype=torch.uint8)
    part = write_onnx(
        _Binary(network.eval()),
        crops,
        out / "paper.onnx",
        source="crops",
        targets=("probabilities",),
        metadata={"weldgate.classes": '["ok", "nok"]'},
    )
    part.replace(out / "paper.onnx")
    found = count(paper_scores(out / "paper.onnx", held_out.images) >= 0.5, held_out.labels != OK)
    card = PaperCard(
        protocol="paper",
        data_hash=digest,
        training_crops=len(training),
        held_out=Decisions(**asdict(found), precision=found.precision, recall=found.recall, f2=found.f2),
        weights=sum(p.numel() for p in network.parameters()),
        seconds=perf_counter() - start,
        plan=plan,
    )
    (out / "run.json").write_text(json.dumps(asdict(card), indent=1) + "\n")
    return card


def paper_scores(path: Path, images: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return the probability of NOK (N,) of crops (N, 128, 128), through a file of this protocol.

    Raises ModelError.
    """
    network = Network(path)
    batches = (images[i : i + BATCH, None] for i in range(0, len(images), BATCH))
    answers = [network.run(("probabilities",), {"crops": batch})[0] for batch in batches]
    return np.asarray(np.concatenate(answers)[:, 1], np.float64)


def _fit(
    network: PaperNet, crops: Crops, plan: PaperPlan, rng: np.random.Generator, *, report: Report
) -> None:
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

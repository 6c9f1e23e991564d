"""Compares the times of the shipped classifier and of the paper's network on the 21 crops of a part."""

import argparse
import statistics
import tempfile
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
import torch
from torch import Tensor, nn

from models.classifier.export import write_onnx
from models.paper.network import PaperNet
from station.classify.onnx import Classifier, Network
from station.domain import SEGMENT_PX, SEGMENTS
from station.files.installation import SHIPPED_NETWORKS

SHIPPED = SHIPPED_NETWORKS / "weldgate.onnx"
ROUNDS = 200
THREADS = 2


class _Plain(nn.Module):
    """The paper's network as it usually runs: it takes three channels of float32, prepared outside."""

    def __init__(self, network: PaperNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, images: Tensor) -> Tensor:
        """Return the logits of images (K, 3, 128, 128)."""
        logits: Tensor = self.network.classes(self.network.features(images).mean(dim=(2, 3)))
        return logits


def main() -> None:
    """Measure in turns and print medians and ratios."""
    parser = argparse.ArgumentParser(prog="python -m deploy.bench.classifier", description=__doc__)
    parser.add_argument(
        "networks", nargs="*", type=Path, default=[SHIPPED], metavar="FILE", help="a network in ONNX format"
    )
    args = parser.parse_args()
    crops = np.random.default_rng(0).integers(0, 256, (SEGMENTS, SEGMENT_PX, SEGMENT_PX), dtype=np.uint8)
    runs: dict[str, Callable[[], object]] = {}
    with tempfile.TemporaryDirectory() as folder:
        images = torch.zeros((SEGMENTS, 3, SEGMENT_PX, SEGMENT_PX))
        path = write_onnx(
            _Plain(PaperNet(3).eval()),
            images,
            Path(folder) / "paper.onnx",
            source="images",
            targets=("logits",),
            metadata={},
        )
        paper = Network(path, THREADS)
        whole = images.numpy()
        runs["the paper's network, 1.6 M weights"] = lambda: paper.run(("logits",), {"images": whole})
        for file in args.networks:
            classifier = Classifier(file, THREADS)
            runs[f"{file}, maps included"] = lambda own=classifier: own(crops)  # type: ignore[misc]
        times: dict[str, list[float]] = {name: [] for name in runs}
        for _ in range(ROUNDS):
            for name, run in runs.items():
                start = perf_counter()
                run()
                times[name].append((perf_counter() - start) * 1000)
    medians = {name: statistics.median(values) for name, values in times.items()}
    first = next(iter(medians.values()))
    print(f"{SEGMENTS} crops, {THREADS} threads, median of {ROUNDS} in turns")
    for name, ms in medians.items():
        print(f"{name:60} {ms:6.2f} ms   {first / ms:4.1f} x")


if __name__ == "__main__":
    main()

"""The trained ring network to an ONNX file, kept only if the file answers as the network does."""

from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from models.classifier.export import example_images, fused, keep, largest_gap, write_onnx
from models.ring.network import RingNet
from station.classify.onnx import RingNetwork
from station.vision.reduced import FINDER_UM_PER_PX

EXAMPLE_PX = (96, 128)
"""Height and width of the example picture."""


class _Fractions(nn.Module):
    """The network with the logistic function behind it, as the file has it."""

    def __init__(self, network: RingNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, pictures: Tensor) -> Tensor:
        """Return covered fractions."""
        return torch.sigmoid(self.network(pictures))


def export_ring(network: RingNet, path: Path, version: str, data_hash: str) -> None:
    """Write the ring network. Raises LearningError if the file and the network answer differently."""
    pictures = torch.from_numpy(example_images((1, 1, *EXAMPLE_PX)))
    metadata = {
        "weldgate.um_per_px": str(FINDER_UM_PER_PX),
        "weldgate.data_hash": data_hash,
        "weldgate.version": version,
    }
    module = _Fractions(fused(network)).eval()
    part = write_onnx(
        module,
        pictures,
        path,
        source="picture",
        targets=("marks",),
        metadata=metadata,
        axes=("height", "width"),
    )
    with torch.no_grad():
        expected = np.asarray(module(pictures).numpy(), np.float64)[0]
    keep(part, path, largest_gap(expected, RingNetwork(part)(pictures.numpy()[0, 0]).values))

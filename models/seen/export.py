"""The trained network to an ONNX file, kept only if the file answers as the network does."""

from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn

from models.classifier.export import example_images, fused, keep, largest_gap, write_onnx
from models.seen.network import SeenNet
from station.classify.onnx import SeenNetwork
from station.domain import SEGMENT_PX, SEGMENTS


class _Shipped(nn.Module):
    """The network as the station runs it: fractions, not logits."""

    def __init__(self, network: SeenNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, crops: Tensor) -> Tensor:
        """Return the hidden fractions (K, 16) of crops (K, 1, 128, 128) uint8."""
        return torch.sigmoid(self.network(crops)[0])


def export_seen(network: SeenNet, path: Path, version: str, data_hash: str) -> None:
    """Write the network. Raises LearningError if the file and the network answer differently."""
    whole = _Shipped(fused(network)).eval()
    crops = torch.from_numpy(example_images((SEGMENTS, 1, SEGMENT_PX, SEGMENT_PX)))
    metadata = {"weldgate.data_hash": data_hash, "weldgate.version": version}
    part = write_onnx(whole, crops, path, source="crops", targets=("hidden",), metadata=metadata)
    with torch.no_grad():
        expected = np.asarray(whole(crops).numpy(), np.float64)
    keep(part, path, largest_gap(expected, SeenNetwork(part)(crops.numpy()[:, 0])))

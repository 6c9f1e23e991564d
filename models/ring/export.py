"""The trained ring network to an ONNX file, kept only if the file answers as the network does."""

from pathlib import Path

import numpy as np
import torch

from models.classifier.export import example_images, keep, largest_gap, write_onnx
from models.ring.network import RingNet
from station.classify.onnx import RingNetwork
from station.vision.polar import COLUMNS, ROWS


def export_ring(network: RingNet, path: Path, version: str, data_hash: str) -> None:
    """Write the ring network. Raises LearningError if the file and the network answer differently."""
    bands = torch.from_numpy(example_images((1, 1, ROWS, COLUMNS)))
    metadata = {"weldgate.data_hash": data_hash, "weldgate.version": version}
    part = write_onnx(network.eval(), bands, path, source="bands", targets=("sectors",), metadata=metadata)
    with torch.no_grad():
        expected = np.asarray(network(bands).numpy(), np.float64)
    keep(part, path, largest_gap(expected, RingNetwork(part).sectors(bands.numpy()[:, 0])))

"""The trained ring network to an ONNX file, kept only if it answers as the network does."""

from pathlib import Path

import numpy as np
import torch

from models.classifier.export import example_images, keep, largest_gap, write_onnx
from models.ring.train import RingNet
from station.classify.onnx import RingNetwork
from station.vision.polar import COLUMNS, ROWS


def export_ring(network: RingNet, path: Path, version: str, data_hash: str) -> None:
    """Write the ring network. Raises LearningError if the answers of the file and the network differ by more than 1e-4."""
    bands = torch.from_numpy(example_images((1, 1, ROWS, COLUMNS)))
    metadata = {"weldgate.data_hash": data_hash, "weldgate.version": version}
    part = write_onnx(network.eval(), bands, path, "bands", ("sectors",), metadata)
    with torch.no_grad():
        wanted = np.asarray(network(bands).numpy(), np.float64)
    keep(part, path, largest_gap(wanted, RingNetwork(part).sectors(bands.numpy()[:, 0])))

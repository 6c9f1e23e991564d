"""Trained networks to ONNX files with their contract in the metadata; kept only if they agree with the networks."""

import json
import os
import warnings
from pathlib import Path

import numpy as np
import onnx
import torch
from numpy.typing import NDArray

from models.errors import LearningError
from models.network import Probabilities, WeldNet
from models.ring import RingNet
from station.classify.onnx import CLASSES, Classifier, RingNetwork
from station.vision.polar import COLUMNS, ROWS

TOLERANCE = 1e-4


def export(network: WeldNet, path: Path, version: str, data_hash: str, hole_threshold: float, missing_threshold: float) -> None:
    """Write the classifier. Raises LearningError if the file's answers differ from the network's by more than 1e-4."""
    crops = torch.from_numpy(np.random.default_rng(0).integers(0, 256, (21, 1, 128, 128), dtype=np.uint8))
    metadata = {
        "weldgate.classes": json.dumps(CLASSES),
        "weldgate.thresholds": json.dumps({"hole": hole_threshold, "missing_weld": missing_threshold}),
        "weldgate.data_hash": data_hash,
        "weldgate.version": version,
    }
    whole = Probabilities(network).eval()
    part = _write(whole, crops, path, "crops", "probabilities", metadata)
    got = np.array([(s.ok, s.hole, s.missing_weld) for s in Classifier(part)(crops.numpy()[:, 0])])
    _keep(part, path, _answer(whole, crops), got)


def export_ring(network: RingNet, path: Path, version: str, data_hash: str) -> None:
    """Write the ring network. Raises LearningError if the file's answers differ from the network's by more than 1e-4."""
    bands = torch.from_numpy(np.random.default_rng(0).integers(0, 256, (1, 1, ROWS, COLUMNS), dtype=np.uint8))
    metadata = {"weldgate.data_hash": data_hash, "weldgate.version": version}
    part = _write(network.eval(), bands, path, "bands", "sectors", metadata)
    _keep(part, path, _answer(network, bands), RingNetwork(part).sectors(bands.numpy()[:, 0]))


def _write(network: torch.nn.Module, example: torch.Tensor, path: Path, source: str, target: str, metadata: dict[str, str]) -> Path:
    part = path.with_suffix(".part.onnx")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # the tracing exporter needs no further package
        torch.onnx.export(
            network,
            (example,),
            str(part),
            input_names=[source],
            output_names=[target],
            dynamic_axes={source: {0: "count"}, target: {0: "count"}},
            opset_version=17,
            dynamo=False,
        )
    model = onnx.load(str(part))
    for key, value in metadata.items():
        entry = model.metadata_props.add()
        entry.key, entry.value = key, value
    onnx.save(model, str(part))
    return part


def _answer(network: torch.nn.Module, example: torch.Tensor) -> NDArray[np.float64]:
    with torch.no_grad():
        return np.asarray(network(example).numpy(), np.float64)


def _keep(part: Path, path: Path, wanted: NDArray[np.float64], got: NDArray[np.float64]) -> None:
    gap = float((np.abs(wanted - got) / np.maximum(1.0, np.abs(wanted))).max())
    if not gap <= TOLERANCE:
        part.unlink()
        raise LearningError(f"{path}: the exported file differs from the network by {gap:.2g}; nothing kept")
    os.replace(part, path)

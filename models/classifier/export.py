"""Trained networks to ONNX files with their contract in the metadata, and back.

A file is kept only if it answers as the network does.
"""

import copy
import json
import shutil
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar, cast

import numpy as np
import onnx
import torch
from numpy.typing import NDArray
from onnx import numpy_helper
from torch import Tensor, nn
from torch.nn.utils.fusion import fuse_conv_bn_eval

from models.classifier.network import STATISTICS, WeldNet
from models.errors import LearningError
from station.classify.onnx import CLASSES, Classifier
from station.classify.thresholds import Thresholds
from station.domain import SEGMENT_PX
from station.files.durable import replacing

AnyNetwork = TypeVar("AnyNetwork", bound=nn.Module)

TOLERANCE = 1e-4
"""Largest difference between the answers of a file and of what it was made from."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Contract:
    """What a classifier's file says about itself in addition to its weights."""

    version: str
    data_hash: str
    """SHA-256 of the training images."""
    thresholds: Thresholds
    mean: NDArray[np.float64]
    """Mean appearance features of the training crops (192,)."""
    whitening: NDArray[np.float64]
    """(192, 192): features minus `mean`, times this, have unit covariance over the training crops."""
    novelty_limit: float
    """Distance of a part to the training images from which it is reported."""
    prior_shift: tuple[float, ...]
    """What is added to the classes' logits: from their fractions in training batches to those on a line."""

    def metadata(self) -> dict[str, str]:
        """Return the metadata of the file."""
        thresholds = {limit.kind.name: limit.threshold for limit in self.thresholds.kinds}
        return {
            "weldgate.classes": json.dumps(CLASSES),
            "weldgate.thresholds": json.dumps(thresholds),
            "weldgate.novelty_limit": json.dumps(self.novelty_limit),
            "weldgate.data_hash": self.data_hash,
            "weldgate.version": self.version,
        }


class Shipped(nn.Module):
    """The network as the station runs it: probabilities, defect map and whitened appearance features."""

    def __init__(self, network: WeldNet, prior_shift: tuple[float, ...]) -> None:
        super().__init__()
        self.network = network
        self.prior_shift: Tensor
        self.register_buffer("prior_shift", torch.tensor(prior_shift))
        self.whiten = nn.Linear(STATISTICS, STATISTICS)

    def forward(self, crops: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Judge crops (K, 1, 128, 128) uint8.

        Returns probabilities (K, classes), maps (K, channels, 32, 32) 0..1 and appearance features (K, 192).
        """
        logits, where, statistics = self.network(crops)
        return (
            torch.softmax(logits + self.prior_shift, dim=1),
            torch.sigmoid(where),
            self.whiten(statistics),
        )


def fused(network: AnyNetwork) -> AnyNetwork:
    """Return a copy with the batch norms folded into the convolutions, as in the file."""
    answer = copy.deepcopy(network).eval()
    for module in answer.modules():
        if isinstance(module, nn.Sequential) and len(module) > 1 and isinstance(module[1], nn.BatchNorm2d):
            module[0] = fuse_conv_bn_eval(cast("nn.Conv2d", module[0]), module[1])
            module[1] = nn.Identity()
    return answer


def export(network: WeldNet, path: Path, contract: Contract) -> None:
    """Write the classifier. Raises LearningError if the file and the network answer differently."""
    whole = Shipped(fused(network), contract.prior_shift).eval()
    with torch.no_grad():
        whole.whiten.weight.copy_(torch.from_numpy(contract.whitening.T))
        whole.whiten.bias.copy_(torch.from_numpy(-contract.mean @ contract.whitening))
    crops = torch.from_numpy(example_images((21, 1, SEGMENT_PX, SEGMENT_PX)))
    outputs = ("probabilities", "maps", "looks")
    part = write_onnx(whole, crops, path, source="crops", targets=outputs, metadata=contract.metadata())
    with torch.no_grad():
        expected = [np.asarray(t.numpy(), np.float64) for t in whole(crops)]
    judged = Classifier(part)(crops.numpy()[:, 0])
    scores = np.array([(s.ok, *s.defects.values()) for s in judged.scores])
    pairs = zip(expected, (scores, judged.maps, judged.appearances), strict=True)
    keep(part, path, max(largest_gap(a, b) for a, b in pairs))


def read_network(path: Path) -> WeldNet:
    """Read a classifier's network from its file, to train it further.

    Raises ModelError if the file is not a classifier, LearningError if its network is not today's.
    """
    classes = tuple(limit.kind.name for limit in Classifier(path).card.thresholds.kinds)
    if classes != CLASSES[1:]:
        known, today = ", ".join(classes), ", ".join(CLASSES[1:])
        raise LearningError(f"{path}: knows {known}, today's kinds are {today}. Train a new network")
    network = fused(WeldNet())
    held = {i.name: numpy_helper.to_array(i).copy() for i in onnx.load(str(path)).graph.initializer}
    weights = {name: held.get(f"network.{name}") for name in network.state_dict()}
    lacking = [name for name, value in weights.items() if value is None]
    if lacking:
        hint = "Name one made by weldgate-models train"
        raise LearningError(f"{path}: not a float32 file of this network, it lacks {lacking[0]}. {hint}")
    network.load_state_dict({k: torch.from_numpy(value) for k, value in weights.items() if value is not None})
    return network


def example_images(shape: tuple[int, ...]) -> NDArray[np.uint8]:
    """Return images of noise, always the same, to trace a network with and to compare its file with it."""
    return np.random.default_rng(0).integers(0, 256, shape, dtype=np.uint8)


def write_onnx(
    module: nn.Module,
    example: Tensor,
    path: Path,
    *,
    source: str,
    targets: tuple[str, ...],
    metadata: dict[str, str],
    axes: tuple[str, ...] = (),
) -> Path:
    """Export to `*.part.onnx` next to `path`, to be checked and renamed, and return its path.

    `source` and `targets` name the input and the outputs; their first axis may be of any length, as may the
    further axes of the input that `axes` names, from the third axis, and those of the outputs.
    """
    part = path.with_suffix(".part.onnx")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # the tracing exporter needs no further package
        # the size of replicated borders is left to the runtime, which folds it
        warnings.filterwarnings("ignore", "Constant folding")
        torch.onnx.export(
            module,
            (example,),
            str(part),
            input_names=[source],
            output_names=list(targets),
            dynamic_axes={name: {0: "count", **dict(enumerate(axes, 2))} for name in (source, *targets)},
            opset_version=17,
            dynamo=False,
        )
    save(onnx.load(str(part)), part, metadata)
    return part


def save(model: onnx.ModelProto, path: Path, metadata: dict[str, str]) -> None:
    """Write a graph with its metadata."""
    for key, value in metadata.items():
        entry = model.metadata_props.add()
        entry.key, entry.value = key, value
    onnx.save(model, str(path))


def largest_gap(expected: NDArray[np.float64], found: NDArray[np.floating]) -> float:
    """Return the largest difference, as a fraction of the largest expected value if that is above 1."""
    return float(np.abs(expected - found).max() / max(1.0, np.abs(expected).max()))


def keep(part: Path, path: Path, gap: float) -> None:
    """Rename a checked file to `path`.

    Raises LearningError if it differs too much from what it was made from.
    """
    if not gap <= TOLERANCE:
        part.unlink()
        raise LearningError(f"{path}: the exported file differs from the network by {gap:.2g}; nothing kept")
    with replacing(path) as whole:
        shutil.copyfile(part, whole)
    part.unlink()

"""Networks through onnxruntime; the station's only file that imports it: crops to scores and maps, a band to ring offsets.

The classifier's file carries its contract in its metadata and is refused without it; the ring network's is known by its input.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime as ort
from numpy.typing import NDArray

from station.classify.extent import CELLS
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS, DefectKind, kind_named
from station.domain import SEGMENT_PX, Image, SegmentScores
from station.errors import ModelError
from station.vision.polar import COLUMNS, ROWS, SECTORS

Array = NDArray[np.float64]

OK = "ok"
CLASSES = (OK, *(kind.name for kind in KINDS))
"""Classes of a network that is trained today, in the order of its probabilities; a file may know fewer."""
MAPPED = tuple(kind for kind in KINDS if kind.is_mapped)
"""Kinds of defect of a network that is trained today, in the order of its defect map's channels."""
LOOK = 192
"""Length of the vector that tells what a crop looks like."""
METADATA_KEYS = (
    "weldgate.classes",
    "weldgate.thresholds",
    "weldgate.novelty_limit",
    "weldgate.data_hash",
    "weldgate.version",
)


@dataclass(frozen=True, slots=True)
class ModelCard:
    """What a model file says of itself."""

    version: str
    data_hash: str
    """SHA-256 over the training labels and images."""
    thresholds: Thresholds
    """Of the kinds of defect that the network knows."""
    novelty_limit: float
    """Distance of a part to the training images from which it is reported."""
    file_hash: str
    """SHA-256 of the file."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """What the network says of K crops."""

    scores: tuple[SegmentScores, ...]
    maps: NDArray[np.float32]
    """Share of each cell that a defect covers, (K, C, 32, 32), one channel for each of the C kinds in `mapped`."""
    mapped: tuple[DefectKind, ...]
    looks: NDArray[np.float32]
    """What each crop looks like (K, 192), of mean 0 and covariance 1 over the training crops."""

    @property
    def novelty(self) -> float:
        """Root mean squared distance of all looks to those of the training crops; about 1 for these."""
        return float(np.sqrt((self.looks.astype(np.float64) ** 2).mean()))


class Network:
    """An ONNX file, loaded."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Raises ModelError if the file is missing or damaged."""
        try:
            blob = path.read_bytes()
        except OSError as error:
            raise ModelError(
                f"{path}: model cannot be read ({error.strerror}); name a weldgate .onnx file in the settings"
            ) from None
        options = ort.SessionOptions()
        options.intra_op_num_threads = threads
        options.inter_op_num_threads = 1
        options.log_severity_level = 4
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")
        try:
            self.session = ort.InferenceSession(blob, options, providers=["CPUExecutionProvider"])
        except Exception as error:  # noqa: BLE001 - onnxruntime raises many kinds
            raise ModelError(
                f"{path}: not a readable ONNX model ({str(error).splitlines()[0][:120]}); restore the file"
            ) from None
        self.file_hash = hashlib.sha256(blob).hexdigest()

    def run(self, outputs: tuple[str, ...], inputs: dict[str, NDArray[Any]]) -> list[NDArray[np.float32]]:
        """The named outputs. Raises ModelError."""
        try:
            return [np.asarray(answer, np.float32) for answer in self.session.run(outputs, inputs)]
        except Exception as error:  # noqa: BLE001 - onnxruntime raises many kinds
            raise ModelError(f"inference failed: {str(error).splitlines()[0][:120]}") from None


class Classifier:
    """A loaded model. `card` says what it is; calling it judges crops."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Load and warm up. Raises ModelError if the file is missing, damaged or not one of weldgate's."""
        self._network = Network(path, threads)
        self.card = _card(path, self._network)
        self(np.zeros((1, SEGMENT_PX, SEGMENT_PX), np.uint8))

    def __call__(self, crops: Image) -> Judged:
        """Judge crops (K, 128, 128) uint8. Raises ModelError if the answer is not K times finite probabilities."""
        p, maps, looks = self._network.run(("probabilities", "maps", "looks"), {"crops": crops[:, None]})
        count, kinds = len(crops), [limit.kind for limit in self.card.thresholds.kinds]
        mapped = tuple(kind for kind in kinds if kind.is_mapped)
        shapes = ((count, 1 + len(kinds)), (count, len(mapped), CELLS, CELLS), (count, LOOK))
        if (p.shape, maps.shape, looks.shape) != shapes:
            raise ModelError(
                f"inference gave no probabilities, maps and looks (shapes {p.shape}, {maps.shape}, {looks.shape})"
            )
        sound = all(((a >= 0) & (a <= 1)).all() for a in (p, maps)) and bool(
            (np.abs(p.sum(axis=1) - 1) <= 1e-3).all()
        )
        if not (sound and np.isfinite(looks).all()):
            raise ModelError("inference gave numbers that are no probabilities")
        scores = (
            SegmentScores(float(row[0]), dict(zip(kinds, map(float, row[1:]), strict=True))) for row in p
        )
        return Judged(tuple(scores), maps, mapped, looks)


class RingNetwork:
    """The network that sees where the weld runs in a flattened band (`vision.polar`)."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Load and warm up. Raises ModelError if the file is missing, damaged or another network."""
        self._network = Network(path, threads)
        self.file_hash = self._network.file_hash
        _check_input(path, self._network.session, "bands", [1, ROWS, COLUMNS])
        self(np.zeros((ROWS, COLUMNS), np.uint8))

    def __call__(self, band: Image) -> tuple[Array, Array]:
        """Offset in px (84,), outwards positive, and presence 0..1 (84,) of each sector of a band (192, 672) uint8.

        The mean over the band's four mirror images, for a mirrored weld is a weld. Raises ModelError.
        """
        a, b, c, d = self.sectors(np.stack([band, band[:, ::-1], band[::-1], band[::-1, ::-1]]))
        offset = (a[0] + b[0, ::-1] - c[0] - d[0, ::-1]) / 4
        return offset, (a[1] + b[1, ::-1] + c[1] + d[1, ::-1]) / 4

    def sectors(self, bands: Image) -> Array:
        """What the network itself says of bands (K, 192, 672) uint8: offsets and presences (K, 2, 84)."""
        (found,) = self._network.run(("sectors",), {"bands": bands[:, None]})
        answer = np.asarray(found, np.float64)
        if answer.shape != (len(bands), 2, SECTORS) or not np.isfinite(answer).all():
            raise ModelError(f"the ring network gave no offsets (shape {answer.shape})")
        return answer


def _check_input(path: Path, session: ort.InferenceSession, name: str, shape: list[int]) -> None:
    inputs = session.get_inputs()
    got = list(inputs[0].shape[1:])
    if len(inputs) != 1 or inputs[0].name != name or inputs[0].type != "tensor(uint8)" or got != shape:
        raise ModelError(
            f"{path}: input is {inputs[0].name} {inputs[0].type} {got}, needed {name} tensor(uint8) {shape}"
        )


def _card(path: Path, network: Network) -> ModelCard:
    session = network.session
    metadata = session.get_modelmeta().custom_metadata_map
    missing = [key for key in METADATA_KEYS if key not in metadata]
    if missing:
        raise ModelError(
            f"{path}: not a weldgate model, metadata lacks {', '.join(missing)}; make one with weldgate-models train"
        )
    _check_input(path, session, "crops", [1, SEGMENT_PX, SEGMENT_PX])
    lacking = {"probabilities", "maps", "looks"} - {o.name for o in session.get_outputs()}
    if lacking:
        raise ModelError(
            f"{path}: has no output {', '.join(sorted(lacking))}; make one with weldgate-models train"
        )
    try:
        classes = [str(name) for name in json.loads(metadata["weldgate.classes"])]
        thresholds = {
            str(name): float(value) for name, value in json.loads(metadata["weldgate.thresholds"]).items()
        }
        limit = float(json.loads(metadata["weldgate.novelty_limit"]))
    except (ValueError, AttributeError, TypeError):
        raise ModelError(
            f"{path}: metadata cannot be read; make it again with weldgate-models train"
        ) from None
    if not 0 < limit < float("inf"):
        raise ModelError(f"{path}: novelty limit {limit} must be above 0")
    return ModelCard(
        version=metadata["weldgate.version"],
        data_hash=metadata["weldgate.data_hash"],
        thresholds=_thresholds(path, classes, thresholds),
        novelty_limit=limit,
        file_hash=network.file_hash,
    )


def _thresholds(path: Path, classes: list[str], thresholds: dict[str, float]) -> Thresholds:
    """Return the thresholds of a file's kinds of defect in the order of its classes."""
    if not (len(classes) > 1 and classes[0] == OK and len(set(classes)) == len(classes)):
        raise ModelError(
            f"{path}: classes are {classes}, needed {OK} and then kinds of defect; make the model again"
        )
    try:
        kinds = [kind_named(name) for name in classes[1:]]
    except ValueError as error:
        raise ModelError(f"{path}: {error}; update weldgate, or name another model") from None
    if set(thresholds) != set(classes[1:]) or not all(0 < value < 1 for value in thresholds.values()):
        raise ModelError(
            f"{path}: thresholds {thresholds} must lie between 0 and 1, one for each of {classes[1:]}"
        )
    return Thresholds(tuple(Limit(kind, thresholds[kind.name]) for kind in kinds))

"""Runs the networks: classifier (crops to scores and defect maps), ring network (picture to marks).

This is the station's only file that imports onnxruntime. A classifier file describes itself in its metadata
and is refused without them; a ring network is recognised by its input.
"""

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import TypeAdapter

from station.classify.extent import CELLS
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS, DefectKind, kind_named
from station.domain import SEGMENT_PX, Image, SegmentScores
from station.errors import ModelError
from station.numbers import Number
from station.vision.marks import CELL_PX, CHANNELS, Marks
from station.vision.reduced import FINDER_UM_PER_PX

# before the import: else it writes an identifier of the machine to disk, and reports its use to its maker
os.environ["ORT_DISABLE_TELEMETRY"] = "1"
import onnxruntime as ort

Array = NDArray[np.float64]

OK = "ok"
"""Name of the class of good crops."""
CLASSES = (OK, *(kind.name for kind in KINDS))
"""Classes of a newly trained network, in the order of its probabilities; an older file may have fewer."""
MAPPED = tuple(kind for kind in KINDS if kind.is_mapped)
"""Kinds of defect in the order of the channels of a newly trained network's defect map."""
APPEARANCE_SIZE = 192
"""Number of appearance features of a crop."""
SEEN_COLUMNS = 16
"""Columns of a crop for which the network says how much of the weld is hidden."""
PADDING_PX = 16
"""Pixels of which the ring network takes whole multiples along each side."""
_CLASSES: TypeAdapter[list[str]] = TypeAdapter(list[str])
_NUMBERS: TypeAdapter[dict[str, float]] = TypeAdapter(dict[str, Number])
_NUMBER: TypeAdapter[float] = TypeAdapter(float)
METADATA_KEYS = (
    "weldgate.classes",
    "weldgate.thresholds",
    "weldgate.novelty_limit",
    "weldgate.data_hash",
    "weldgate.version",
)
"""Metadata that a classifier file must have."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelCard:
    """Description of a classifier, read from the metadata of its file."""

    version: str
    data_hash: str
    """SHA-256 of the training labels and images."""
    thresholds: Thresholds
    """Thresholds of the kinds of defect that the network knows."""
    novelty_limit: float
    """Novelty above which a part is reported."""
    file_hash: str
    """SHA-256 of the file."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """Output of the classifier for K crops."""

    scores: tuple[SegmentScores, ...]
    maps: NDArray[np.float32]
    """Covered fraction of each cell (K, C, 32, 32), one channel for each of the C kinds in `mapped`."""
    mapped: tuple[DefectKind, ...]
    appearances: NDArray[np.float32]
    """Appearance features (K, 192), whitened on the training crops (zero mean, unit covariance)."""

    @property
    def novelty(self) -> float:
        """Root mean square distance of the appearances from the training crops, for which it is about 1."""
        return float(np.sqrt((self.appearances.astype(np.float64) ** 2).mean()))


class Network:
    """A loaded ONNX file."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Load the file. Raises ModelError if it is missing or damaged."""
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
        """Return the named outputs. Raises ModelError."""
        try:
            return [np.asarray(output, np.float32) for output in self.session.run(outputs, inputs)]
        except Exception as error:  # noqa: BLE001 - onnxruntime raises many kinds
            raise ModelError(f"inference failed: {str(error).splitlines()[0][:120]}") from None


class Classifier:
    """A loaded classifier, described by `card`; call it to judge crops."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Load and warm up the network. Raises ModelError if the file is not a classifier."""
        self._network = Network(path, threads)
        self.card = _card(path, self._network)
        self(np.zeros((1, SEGMENT_PX, SEGMENT_PX), np.uint8))

    def __call__(self, crops: Image) -> Judged:
        """Return scores, maps and appearances of crops (K, 128, 128) uint8.

        Raises ModelError if the network fails or its output is not finite or not a set of probabilities.
        """
        outputs = self._network.run(("probabilities", "maps", "looks"), {"crops": crops[:, None]})
        probabilities, maps, appearances = outputs
        count, kinds = len(crops), [limit.kind for limit in self.card.thresholds.kinds]
        mapped = tuple(kind for kind in kinds if kind.is_mapped)
        shapes = ((count, 1 + len(kinds)), (count, len(mapped), CELLS, CELLS), (count, APPEARANCE_SIZE))
        if tuple(output.shape for output in outputs) != shapes:
            got = ", ".join(str(output.shape) for output in outputs)
            raise ModelError(f"inference failed: the output has the shapes {got}, needed {shapes}")
        sound = all(((output >= 0) & (output <= 1)).all() for output in (probabilities, maps)) and bool(
            (np.abs(probabilities.sum(axis=1) - 1) <= 1e-3).all()
        )
        if not (sound and np.isfinite(appearances).all()):
            raise ModelError("inference failed: the output is not a set of probabilities")
        scores = (
            SegmentScores(float(row[0]), dict(zip(kinds, map(float, row[1:]), strict=True)))
            for row in probabilities
        )
        return Judged(tuple(scores), maps, mapped, appearances)


class RingNetwork:
    """The network that marks weld and bare joint on a picture at 52 µm/px (`station.vision.marks`)."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Load and warm up the network. Raises ModelError if the file is not a ring network."""
        self._network = Network(path, threads)
        self.file_hash = self._network.file_hash
        _check_ring(path, self._network.session)
        self(np.zeros((PADDING_PX, PADDING_PX), np.uint8))

    def __call__(self, picture: Image) -> Marks:
        """Return the marks on a picture (height, width) uint8 at 52 µm/px. Raises ModelError.

        The picture's last row and column are repeated up to a multiple of 16 px, and marked like the rest.
        """
        height, width = picture.shape
        below, right = -height % PADDING_PX, -width % PADDING_PX
        padded = np.pad(picture, ((0, below), (0, right)), mode="edge")
        (output,) = self._network.run(("marks",), {"picture": padded[None, None]})
        shape = (1, CHANNELS, padded.shape[0] // CELL_PX, padded.shape[1] // CELL_PX)
        if output.shape != shape or not ((output >= 0) & (output <= 1)).all():
            raise ModelError(f"ring network failed: the output is not a set of marks (shape {output.shape})")
        return Marks(output[0])


class SeenNetwork:
    """The network that says how much of the weld is hidden in a crop, by anything at all."""

    def __init__(self, path: Path, threads: int = 2) -> None:
        """Load and warm up the network. Raises ModelError if the file is not such a network."""
        self._network = Network(path, threads)
        self.file_hash = self._network.file_hash
        _check_input(path, self._network.session, "crops", [1, SEGMENT_PX, SEGMENT_PX])
        if [output.name for output in self._network.session.get_outputs()] != ["hidden"]:
            raise ModelError(
                f"{path}: not a network that says what is hidden; make one with weldgate-models train-seen"
            )
        self(np.zeros((1, SEGMENT_PX, SEGMENT_PX), np.uint8))

    def __call__(self, crops: Image) -> Array:
        """Return the hidden fraction of the weld (K, 16), 0 to 1, of crops (K, 128, 128) uint8.

        There are 16 columns of 8 px along the weld. Raises ModelError.
        """
        (output,) = self._network.run(("hidden",), {"crops": crops[:, None]})
        hidden = np.asarray(output, np.float64)
        if hidden.shape != (len(crops), SEEN_COLUMNS) or not ((hidden >= 0) & (hidden <= 1)).all():
            raise ModelError(f"the output is not a set of hidden fractions (shape {hidden.shape})")
        return hidden


def _check_ring(path: Path, session: ort.InferenceSession) -> None:
    """Raise ModelError if a file is not a ring network of today's form and scale."""
    metadata = session.get_modelmeta().custom_metadata_map
    scale = metadata.get("weldgate.um_per_px")
    if scale is None or {output.name for output in session.get_outputs()} != {"marks"}:
        raise ModelError(
            f"{path}: not a ring network, or one of an earlier form; make one with weldgate-models train-ring"
        )
    if scale != str(FINDER_UM_PER_PX):
        raise ModelError(
            f"{path}: trained at {scale} µm/px, needed {FINDER_UM_PER_PX}; "
            "make one with weldgate-models train-ring"
        )
    _check_input(path, session, "picture", [1, "height", "width"])


def _check_input(path: Path, session: ort.InferenceSession, name: str, shape: list[int | str]) -> None:
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
            f"{path}: not a weldgate classifier, {', '.join(missing)} missing in its metadata; "
            "make one with weldgate-models train"
        )
    _check_input(path, session, "crops", [1, SEGMENT_PX, SEGMENT_PX])
    lacking = {"probabilities", "maps", "looks"} - {output.name for output in session.get_outputs()}
    if lacking:
        raise ModelError(
            f"{path}: output {', '.join(sorted(lacking))} is missing; make a model with weldgate-models train"
        )
    try:
        classes = _CLASSES.validate_json(metadata["weldgate.classes"], strict=True)
        thresholds = _NUMBERS.validate_json(metadata["weldgate.thresholds"], strict=True)
        limit = _NUMBER.validate_json(metadata["weldgate.novelty_limit"], strict=True)
    except ValueError:
        raise ModelError(
            f"{path}: metadata cannot be read; make the model again with weldgate-models train"
        ) from None
    if not 0 < limit < float("inf"):
        raise ModelError(f"{path}: novelty limit {limit} must be above 0; make the model again")
    return ModelCard(
        version=metadata["weldgate.version"],
        data_hash=metadata["weldgate.data_hash"],
        thresholds=_thresholds(path, classes, thresholds),
        novelty_limit=limit,
        file_hash=network.file_hash,
    )


def _thresholds(path: Path, classes: list[str], thresholds: dict[str, float]) -> Thresholds:
    """Return the thresholds of the kinds of defect in a file, in the order of its classes."""
    if not (len(classes) > 1 and classes[0] == OK and len(set(classes)) == len(classes)):
        raise ModelError(
            f"{path}: classes are {classes}, needed {OK} followed by kinds of defect; make the model again"
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

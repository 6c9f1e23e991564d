"""The classifier's file in 8 bits, kept only if it judges as well.

The only file that imports onnxruntime's quantizer.
"""

import contextlib
import io
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import onnx
from numpy.typing import NDArray
from onnxruntime.quantization import (
    CalibrationDataReader,
    CalibrationMethod,
    QuantFormat,
    QuantType,
    quantize_static,
)
from onnxruntime.quantization.shape_inference import quant_pre_process

from models.data.crops import OK, Crops
from models.errors import LearningError
from models.evaluation.measures import count, rejected
from models.evaluation.scores import class_scores
from station.classify.onnx import Classifier
from station.files.durable import write_whole

CALIBRATION_CROPS = 400
LOSS_F2 = 0.003
"""Largest loss of F2 on the held-out crops that is accepted for the speed."""


@dataclass(frozen=True, slots=True)
class Quantized:
    """F2 on the held-out crops of both files."""

    float32: float
    int8: float


class _Batches(CalibrationDataReader):  # type: ignore[misc]
    def __init__(self, crops: Crops) -> None:
        number = min(CALIBRATION_CROPS, len(crops))
        chosen = np.random.default_rng(0).choice(len(crops), number, replace=False)
        batches = [{"crops": crops.images[i : i + 1, None]} for i in chosen]
        self._batches: Iterator[dict[str, NDArray[np.uint8]]] = iter(batches)

    def get_next(self) -> dict[str, NDArray[np.uint8]] | None:
        """Return one crop, or None at the end."""
        return next(self._batches, None)


def quantize(path: Path, target: Path, training: Crops, held_out: Crops) -> Quantized:
    """Write `target`, the 8-bit file of the float32 file `path`, calibrated on training crops.

    Raises LearningError if it judges the held-out crops worse than the float32 file by more than 0.3 % of F2;
    nothing is kept then.
    """
    with tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
        prepared, part = Path(folder) / "prepared.onnx", Path(folder) / "part.onnx"
        quant_pre_process(str(path), str(prepared), skip_symbolic_shape=True)
        with contextlib.redirect_stdout(io.StringIO()):  # it prints its progress
            quantize_static(
                str(prepared),
                str(part),
                _Batches(training),
                quant_format=QuantFormat.QDQ,
                per_channel=True,
                activation_type=QuantType.QUInt8,
                weight_type=QuantType.QInt8,
                calibrate_method=CalibrationMethod.MinMax,
                op_types_to_quantize=["Conv"],
            )
        model = onnx.load(str(part))
        if not model.metadata_props:
            model.metadata_props.extend(onnx.load(str(path)).metadata_props)
            onnx.save(model, str(part))
        found = Quantized(_f2(path, held_out), _f2(part, held_out))
        if found.int8 < found.float32 - LOSS_F2:
            fall = f"F2 falls from {found.float32:.4f} to {found.int8:.4f} in 8 bits"
            raise LearningError(f"{target}: {fall}; nothing kept. Use the float32 file")
        write_whole(target, part.read_bytes())
    return found


def _f2(path: Path, crops: Crops) -> float:
    classifier = Classifier(path)
    nok = rejected(class_scores(classifier, crops.images), classifier.card.thresholds)
    return count(nok, crops.labels != OK).f2

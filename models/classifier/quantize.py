"""The classifier's file in 8 bits, kept only if it judges as well; the only file that imports onnxruntime's quantizer."""

import contextlib
import io
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import onnx
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

CALIBRATION_CROPS = 400
LOSS_F2 = 0.003
"""Largest loss of F2 on the held-out crops that is taken for the speed."""


class _Batches(CalibrationDataReader):  # type: ignore[misc]
    def __init__(self, crops: Crops) -> None:
        chosen = np.random.default_rng(0).choice(
            len(crops), min(CALIBRATION_CROPS, len(crops)), replace=False
        )
        self._batches: Iterator[dict[str, Any]] = iter(
            [{"crops": crops.images[i : i + 1, None]} for i in chosen]
        )

    def get_next(self) -> dict[str, Any] | None:
        """One crop, or None at the end."""
        return next(self._batches, None)


def quantize(path: Path, target: Path, training: Crops, held: Crops) -> dict[str, float]:
    """Write `target`, the 8-bit file of the float32 file `path`, calibrated on training crops; returns both F2 on the held-out crops.

    Raises LearningError if it judges them worse than the float32 file by more than 0.3 % of F2; nothing is kept then.
    """
    card = Classifier(path).card
    prepared, part = target.with_suffix(".prepared.onnx"), target.with_suffix(".part.onnx")
    try:
        quant_pre_process(str(path), str(prepared), skip_symbolic_shape=True)
        with contextlib.redirect_stdout(io.StringIO()):  # it tells its progress
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
        f2 = [
            count(rejected(class_scores(Classifier(p), held.images), card.thresholds), held.labels != OK).f2
            for p in (path, part)
        ]
        if f2[1] < f2[0] - LOSS_F2:
            raise LearningError(
                f"{target}: F2 falls from {f2[0]:.4f} to {f2[1]:.4f} in 8 bits; nothing kept, use the float32 file"
            )
        os.replace(part, target)
    finally:
        for path_left in (prepared, part):
            path_left.unlink(missing_ok=True)
    return {"float32": f2[0], "int8": f2[1]}

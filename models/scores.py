"""Scores of many crops through the file and the station's reader."""

import numpy as np
from numpy.typing import NDArray

from station.classify.onnx import Classifier

BATCH = 256


def class_scores(classifier: Classifier, images: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Probabilities (N, 3) of ok, hole and missing weld of crops (N, 128, 128) uint8. Raises ModelError."""
    batches = (classifier(images[i : i + BATCH]).scores for i in range(0, len(images), BATCH))
    return np.array([(s.ok, s.hole, s.missing_weld) for batch in batches for s in batch])

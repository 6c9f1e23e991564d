"""Scores of many crops, from a classifier's file through the station's own reader."""

import numpy as np
from numpy.typing import NDArray

from station.classify.onnx import Classifier
from station.defects import KINDS
from station.domain import SegmentScores

BATCH = 256


def class_scores(classifier: Classifier, images: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Return probabilities (N, classes) of crops (N, 128, 128) uint8, columns as in `CLASSES`.

    Raises ModelError.
    """
    batches = (classifier(images[i : i + BATCH]).scores for i in range(0, len(images), BATCH))
    return np.array([row_of(scores) for batch in batches for scores in batch])


def row_of(scores: SegmentScores) -> tuple[float, ...]:
    """Return the probabilities in the order of `CLASSES`; 0 for kinds of defect unknown to the classifier."""
    return scores.ok, *(scores.defects.get(kind, 0.0) for kind in KINDS)

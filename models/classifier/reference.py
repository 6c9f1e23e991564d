"""The reference of a line's good parts, with which the station's drift watch compares."""

import numpy as np
from numpy.typing import NDArray

from models.errors import LearningError
from station.classify.drift import DriftWatch, Reference

Array = NDArray[np.float64]

MIN_PARTS = 20
RUNS, RUN_PARTS = 200, 100
FALSE_ALARM = 0.01
"""Fraction of the runs without drift that exceed the limit, before the margin."""
MARGIN = 1.3
"""Factor of the limit above that: a month is longer than the runs and varies more than a day."""


def make_reference(features: Array, model_hash: str, seed: int = 0) -> Reference:
    """Return mean, spread and limit of the appearance features (N, D) of good parts.

    The limit comes from runs of the parts in random order, each compared with a reference made of the others,
    so that the size of the sample is part of it. Raises LearningError with fewer than 20 parts.
    """
    if len(features) < MIN_PARTS:
        count = f"{len(features)} good parts were judged; a reference needs at least {MIN_PARTS}"
        raise LearningError(f"{count}. Add images of good parts")
    if (features == features[0]).all():
        raise LearningError("the images of all parts are the same. A reference needs different parts")
    mean, spread = _describe(features)
    size = len(mean)
    unlike = []
    for i in range(len(features)):
        others_mean, others_spread = _describe(np.delete(features, i, axis=0))
        unlike.append((features[i] - others_mean) / others_spread)
    rng = np.random.default_rng(seed)
    plain = Reference(
        model_hash=model_hash, parts=len(features), mean=(0.0,) * size, spread=(1.0,) * size, limit=1.0
    )
    peaks = []
    for _ in range(RUNS):
        watch = DriftWatch(plain)
        chosen = rng.integers(0, len(features), RUN_PARTS)
        peaks.append(max(watch.part(unlike[i]).value for i in chosen))
    limit = MARGIN * (float(np.quantile(peaks, 1 - FALSE_ALARM)) + 1 / len(features))
    return Reference(
        model_hash=model_hash,
        parts=len(features),
        mean=tuple(np.round(mean, 5).tolist()),
        spread=tuple(np.round(spread, 5).tolist()),
        limit=round(limit, 4),
    )


def _describe(features: Array) -> tuple[Array, Array]:
    """Return mean and spread (D,).

    Each variance is moved half-way to the median of all: a few parts give poor single variances.
    """
    variance = features.var(axis=0, ddof=1)
    return features.mean(axis=0), np.sqrt((variance + np.median(variance)) / 2)

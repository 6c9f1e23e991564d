"""The reference of a line's good parts, which the station's drift watch compares with."""

import numpy as np
from numpy.typing import NDArray

from models.errors import LearningError
from station.classify.drift import DriftWatch, Reference

Array = NDArray[np.float64]

MIN_PARTS = 20
RUNS, RUN_PARTS = 200, 100
FALSE_ALARM = 0.01
"""Share of the runs without drift that go above the limit, before the margin."""
MARGIN = 1.3
"""A month is longer than the runs, and varies more than a day."""


def make_reference(looks: Array, model_hash: str, seed: int = 0) -> Reference:
    """Mean, spread and limit from looks (N, D) of good parts.

    The limit comes from runs of the parts in random order, each seen against a reference made of the others, so that the size of the
    sample is part of it. Raises LearningError with fewer than 20 parts.
    """
    if len(looks) < MIN_PARTS:
        raise LearningError(f"{len(looks)} good parts were judged; a reference needs at least {MIN_PARTS}")
    if (looks == looks[0]).all():
        raise LearningError("the pictures of all parts are the same; a reference needs different parts")
    mean, spread = _describe(looks)
    size = len(mean)
    unlike = []
    for i in range(len(looks)):
        others_mean, others_spread = _describe(np.delete(looks, i, axis=0))
        unlike.append((looks[i] - others_mean) / others_spread)
    rng = np.random.default_rng(seed)
    plain = Reference(model_hash, len(looks), (0.0,) * size, (1.0,) * size, 1.0)
    peaks = []
    for _ in range(RUNS):
        watch = DriftWatch(plain)
        peaks.append(max(watch.part(unlike[i]).value for i in rng.integers(0, len(looks), RUN_PARTS)))
    limit = MARGIN * (float(np.quantile(peaks, 1 - FALSE_ALARM)) + 1 / len(looks))
    rounded = [tuple(np.round(a, 5).tolist()) for a in (mean, spread)]
    return Reference(model_hash, len(looks), rounded[0], rounded[1], round(limit, 4))


def _describe(looks: Array) -> tuple[Array, Array]:
    """Mean and spread (D,), each variance drawn half-way to the median of all: a few parts tell the single ones badly."""
    variance = looks.var(axis=0, ddof=1)
    return looks.mean(axis=0), np.sqrt((variance + np.median(variance)) / 2)

"""Figures of merit and thresholds from scores and labels; positive means NOK. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from models.data.crops import DEFECTS, OK
from station.classify.decision import segment_kind
from station.classify.onnx import CLASSES
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS
from station.domain import SegmentScores

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
THRESHOLDS = np.arange(0.2, 0.501, 0.02)
"""Thresholds to choose from.

At 0.5 both errors cost the same; far below it a few crops would decide the choice.
"""

SWEEPS = 3
"""Rounds over all kinds of defect in which their thresholds are chosen in turns."""

LINE_FRACTIONS = (1.0 - sum(kind.line_fraction for kind in KINDS), *(kind.line_fraction for kind in KINDS))
"""Fractions of a line's segments that are OK and that show each kind of defect, in the order of `CLASSES`.

Scores are given and thresholds are chosen for them. Half of the training crops are NOK, but hardly any of a
line's: there a segment is more likely to be OK before it is seen, and there are more OK ones to reject
falsely.
"""
ESCAPE_COST = 4.0
"""Number of false rejects that weigh as much as one escape, as in F2 (beta squared)."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Numbers of right and wrong decisions."""

    tp: int
    fp: int
    fn: int
    tn: int

    @property
    def precision(self) -> float:
        """Eq. (7) of the paper; 1 if nothing was rejected."""
        return self.tp / (self.tp + self.fp) if self.tp + self.fp else 1.0

    @property
    def recall(self) -> float:
        """Eq. (6) of the paper; 1 if there was nothing to find."""
        return self.tp / (self.tp + self.fn) if self.tp + self.fn else 1.0

    @property
    def f2(self) -> float:
        """Eq. (8) of the paper."""
        p, r = self.precision, self.recall
        return 5 * p * r / (4 * p + r) if p + r else 0.0


def count(nok: Flags, truth: Flags) -> Counts:
    """Count decisions (N,) against truths (N,)."""
    return Counts(
        tp=int((nok & truth).sum()),
        fp=int((nok & ~truth).sum()),
        fn=int((~nok & truth).sum()),
        tn=int((~nok & ~truth).sum()),
    )


def decided(scores: Array, thresholds: Thresholds) -> NDArray[np.int64]:
    """Return what the station decides on scores (N, classes): OK or the label of a kind of defect (N,)."""
    kinds = [limit.kind for limit in thresholds.kinds]
    columns = [CLASSES.index(kind.name) for kind in kinds]
    label = dict(zip(kinds, columns, strict=True))
    found = np.full(len(scores), OK, np.int64)
    for row, (ok, *defects) in enumerate(scores[:, [OK, *columns]].tolist()):
        kind = segment_kind(SegmentScores(ok, dict(zip(kinds, defects, strict=True))), thresholds)
        if kind is not None:
            found[row] = label[kind]
    return found


def rejected(scores: Array, thresholds: Thresholds) -> Flags:
    """Return whether the station rejects crops (N,), from scores (N, classes)."""
    return np.asarray(decided(scores, thresholds) != OK, bool)


def calibration_error(nok: Array, truth: Flags, weights: Array | None = None, bins: int = 10) -> float:
    """Return the expected calibration error of probabilities of NOK (N,).

    This is the mean gap between the probability and the fraction of NOK crops, weighted by bin.
    """
    weights = np.ones(len(nok)) if weights is None else weights
    at = np.minimum((nok * bins).astype(int), bins - 1)
    gaps = np.bincount(at, weights * nok, bins) - np.bincount(at, weights * truth, bins)
    return float(np.abs(gaps).sum() / max(float(weights.sum()), 1e-12))


def prior_shift(batch_fractions: tuple[float, ...]) -> tuple[float, ...]:
    """Return what Bayes' rule adds to logits that were trained with these fractions, for use on a line.

    A NOK segment counts `ESCAPE_COST` times. A kind of defect that was not trained keeps its logit.
    """
    costs = (1.0, *(ESCAPE_COST for _ in DEFECTS))
    triples = zip(LINE_FRACTIONS, costs, batch_fractions, strict=True)
    return tuple(float(np.log(line * cost / batch)) if batch > 0 else 0.0 for line, cost, batch in triples)


def shifted(scores: Array, shift: tuple[float, ...]) -> Array:
    """Return the probabilities (N, classes) after adding `shift` to their logits."""
    weighed = scores * np.exp(shift)
    return np.asarray(weighed / weighed.sum(axis=1, keepdims=True))


def line_weights(labels: NDArray[np.int64], escape_cost: float = 1.0) -> Array:
    """Return weights (N,) with which crops represent a line's, a NOK one `escape_cost` times."""
    found = np.ones(len(labels))
    for label, fraction in enumerate(LINE_FRACTIONS):
        cost = 1.0 if label == OK else escape_cost
        found[labels == label] = fraction * cost / max(int((labels == label).sum()), 1)
    return found


def choose_thresholds(scores: Array, labels: NDArray[np.int64], beta: float = 2.0) -> Thresholds:
    """Return the thresholds of all kinds of defect with the best F-beta on a line.

    Of those as good within 0.1 %, the middle one is taken. An escape weighs beta squared times a false
    reject. Thresholds above 0.5 act as 0.5: a segment that is not more likely OK is rejected. With more than
    two kinds of defect the grid is searched kind by kind, in turns.
    """
    value = FBeta(scores, labels, beta)
    if len(DEFECTS) <= 2:
        chosen = _middle_of_best(value, [range(THRESHOLDS.size)] * len(DEFECTS))
    else:
        chosen = [THRESHOLDS.size // 2] * len(DEFECTS)
        for _ in range(SWEEPS):
            for kind in range(len(DEFECTS)):
                places = [range(i, i + 1) for i in chosen]
                places[kind] = range(THRESHOLDS.size)
                chosen = _middle_of_best(value, places)
    pairs = zip(KINDS, chosen, strict=True)
    return Thresholds(tuple(Limit(kind, round(float(THRESHOLDS[i]), 3)) for kind, i in pairs))


class FBeta:
    """F-beta on a line at thresholds given by their places in `THRESHOLDS`, one for each kind of defect."""

    def __init__(self, scores: Array, labels: NDArray[np.int64], beta: float) -> None:
        self._over = [scores[:, kind, None] >= THRESHOLDS for kind in DEFECTS]
        self._likelier_nok = scores[:, OK] <= scores[:, 1:].max(axis=1)
        self._truth, self._weights, self._beta2 = labels != OK, line_weights(labels), beta**2

    def rejected(self, places: Sequence[int]) -> Flags:
        """Return what `measures.rejected` returns at these thresholds, but a hundred times faster."""
        nok = self._likelier_nok.copy()
        for over, place in zip(self._over, places, strict=True):
            nok |= over[:, place]
        return np.asarray(nok, bool)

    def __call__(self, places: Sequence[int]) -> float:
        """Return F-beta at these thresholds."""
        nok = self.rejected(places)
        tp = float((self._weights * (nok & self._truth)).sum())
        fp = float((self._weights * (nok & ~self._truth)).sum())
        fn = float((self._weights * self._truth).sum()) - tp
        return (1 + self._beta2) * tp / ((1 + self._beta2) * tp + self._beta2 * fn + fp)


def _middle_of_best(value: FBeta, places: Sequence[range]) -> list[int]:
    """Return the place nearest to the median of those that are as good as the best within 0.1 %."""
    grid = list(product(*places))
    values = np.array([value(place) for place in grid])
    good = np.array(grid)[values >= values.max() - 0.001]
    centre = np.median(good, axis=0)
    return [int(i) for i in good[np.abs(good - centre).sum(axis=1).argmin()]]

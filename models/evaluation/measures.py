"""Figures of merit; positive means NOK. Pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from models.data.crops import DEFECTS, OK
from station.classify.onnx import CLASSES
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
THRESHOLDS = np.arange(0.2, 0.501, 0.02)
"""Among which is chosen. 0.5 is where both errors cost the same; far below it a few crops would rule the choice."""

SWEEPS = 3
"""Rounds over all kinds of defect in which their thresholds are chosen in turns."""


@dataclass(frozen=True, slots=True)
class Counts:
    """Right and wrong decisions."""

    tp: int
    fp: int
    fn: int
    tn: int

    @property
    def precision(self) -> float:
        """Eq. (7) of the paper; 1 if nothing was refused."""
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
    """Counts of decisions (N,) against truths (N,)."""
    return Counts(int((nok & truth).sum()), int((nok & ~truth).sum()), int((~nok & truth).sum()), int((~nok & ~truth).sum()))


def refused(scores: Array, thresholds: Thresholds) -> Flags:
    """The station's decision (`station.classify.decision.segment_kind`) on scores (N, classes)."""
    columns = [CLASSES.index(limit.kind.name) for limit in thresholds.kinds]
    over = (scores[:, columns] >= [limit.threshold for limit in thresholds.kinds]).any(axis=1)
    return np.asarray(over | (scores[:, OK] <= scores[:, 1:].max(axis=1)), bool)


def calibration_error(nok: Array, truth: Flags, weights: Array | None = None, bins: int = 10) -> float:
    """Expected calibration error of probabilities of NOK (N,): mean gap between score and share of NOK, weighted by bin."""
    weights = np.ones(len(nok)) if weights is None else weights
    at = np.minimum((nok * bins).astype(int), bins - 1)
    gaps = np.bincount(at, weights * nok, bins) - np.bincount(at, weights * truth, bins)
    return float(np.abs(gaps).sum() / max(float(weights.sum()), 1e-12))


LINE_SHARES = (1.0 - sum(kind.line_fraction for kind in KINDS), *(kind.line_fraction for kind in KINDS))
"""Shares of OK and of each kind of defect for which scores are given and thresholds are chosen. Training crops are half NOK, a
line's hardly ever: there an OK segment is likelier before it is looked at, and there are more of them to refuse wrongly."""
ESCAPE_COST = 4.0
"""An escape weighs as many false rejects, as in F2 (beta squared): scores of 0.5 are where both cost the same."""


def prior_shift(batch_shares: tuple[float, ...]) -> tuple[float, ...]:
    """What Bayes' rule adds to the logits when the classes' shares are those of a line, a NOK segment counting `ESCAPE_COST` times, and
    not those of the training batches.

    A kind that was not trained keeps its logit.
    """
    costs = (1.0, *(ESCAPE_COST for _ in DEFECTS))
    pairs = zip(LINE_SHARES, costs, batch_shares, strict=True)
    return tuple(float(np.log(line * cost / batch)) if batch > 0 else 0.0 for line, cost, batch in pairs)


def shifted(scores: Array, shift: tuple[float, ...]) -> Array:
    """Probabilities (N, classes) after adding `shift` to their logits."""
    weighed = scores * np.exp(shift)
    return np.asarray(weighed / weighed.sum(axis=1, keepdims=True))


def line_weights(labels: NDArray[np.int64], escape_cost: float = 1.0) -> Array:
    """Weights (N,) by which crops stand for a line's, a NOK one `escape_cost` times."""
    found = np.ones(len(labels))
    for kind, share in enumerate(LINE_SHARES):
        found[labels == kind] = share * (1.0 if kind == OK else escape_cost) / max(int((labels == kind).sum()), 1)
    return found


def choose_thresholds(scores: Array, labels: NDArray[np.int64], beta: float = 2.0) -> Thresholds:
    """Return the thresholds of all kinds of defect with the best F-beta on a line; of those as good within 0.1 %, the middle one.

    An escape weighs beta squared times a false reject. Limits above 0.5 act as 0.5: what is not likelier OK is rejected. The grid
    over all kinds is searched kind by kind in turns if there are more than two.
    """
    value = _FBeta(scores, labels, beta)
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


class _FBeta:
    """F-beta of a line at thresholds that are given by their places in `THRESHOLDS`, one for each kind of defect."""

    def __init__(self, scores: Array, labels: NDArray[np.int64], beta: float) -> None:
        self._over = [scores[:, kind, None] >= THRESHOLDS for kind in DEFECTS]
        self._sure = scores[:, OK] <= scores[:, 1:].max(axis=1)
        self._truth, self._weights, self._beta2 = labels != OK, line_weights(labels), beta**2

    def __call__(self, places: Sequence[int]) -> float:
        nok = self._sure.copy()
        for over, place in zip(self._over, places, strict=True):
            nok |= over[:, place]
        tp = float((self._weights * (nok & self._truth)).sum())
        fp = float((self._weights * (nok & ~self._truth)).sum())
        fn = float((self._weights * self._truth).sum()) - tp
        return (1 + self._beta2) * tp / ((1 + self._beta2) * tp + self._beta2 * fn + fp)


def _middle_of_best(value: _FBeta, places: Sequence[range]) -> list[int]:
    """Return the place nearest to the median of those that are as good as the best within 0.1 %."""
    grid = list(product(*places))
    values = np.array([value(place) for place in grid])
    good = np.array(grid)[values >= values.max() - 0.001]
    centre = np.median(good, axis=0)
    return [int(i) for i in good[np.abs(good - centre).sum(axis=1).argmin()]]

"""Figures of merit; positive means NOK. Pure."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.crops import HOLE, MISSING, OK
from station.classify.thresholds import Thresholds

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
THRESHOLDS = np.arange(0.2, 0.501, 0.02)
"""Among which is chosen. 0.5 is where both errors cost the same; far below it a few crops would rule the choice."""


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
    """The station's decision (`station.classify.decision.segment_kind`) on scores (N, 3)."""
    over = (scores[:, HOLE] >= thresholds.hole) | (scores[:, MISSING] >= thresholds.missing_weld)
    return np.asarray(over | (scores[:, OK] <= scores[:, 1:].max(axis=1)), bool)


def calibration_error(nok: Array, truth: Flags, weights: Array | None = None, bins: int = 10) -> float:
    """Expected calibration error of probabilities of NOK (N,): mean gap between score and share of NOK, weighted by bin."""
    weights = np.ones(len(nok)) if weights is None else weights
    at = np.minimum((nok * bins).astype(int), bins - 1)
    gaps = np.bincount(at, weights * nok, bins) - np.bincount(at, weights * truth, bins)
    return float(np.abs(gaps).sum() / max(float(weights.sum()), 1e-12))


LINE_SHARES = (0.9, 0.06, 0.04)
"""Shares of OK, hole and missing weld for which scores are given and thresholds are chosen. Training crops are half NOK, a line's hardly
ever: there an OK segment is likelier before it is looked at, and there are more of them to refuse wrongly."""
ESCAPE_COST = 4.0
"""An escape weighs as many false rejects, as in F2 (beta squared): scores of 0.5 are where both cost the same."""


def prior_shift(batch_shares: tuple[float, float, float]) -> tuple[float, float, float]:
    """What Bayes' rule adds to the logits when the classes' shares are those of a line, a NOK segment counting `ESCAPE_COST` times, and
    not those of the training batches.

    A kind that was not trained keeps its logit.
    """
    pairs = zip(LINE_SHARES, (1.0, ESCAPE_COST, ESCAPE_COST), batch_shares, strict=True)
    ok, hole, gone = (float(np.log(line * cost / batch)) if batch > 0 else 0.0 for line, cost, batch in pairs)
    return ok, hole, gone


def shifted(scores: Array, shift: tuple[float, float, float]) -> Array:
    """Probabilities (N, 3) after adding `shift` to their logits."""
    weighed = scores * np.exp(shift)
    return np.asarray(weighed / weighed.sum(axis=1, keepdims=True))


def line_weights(labels: NDArray[np.int64], escape_cost: float = 1.0) -> Array:
    """Weights (N,) by which crops stand for a line's, a NOK one `escape_cost` times."""
    found = np.ones(len(labels))
    for kind, share in enumerate(LINE_SHARES):
        found[labels == kind] = share * (1.0 if kind == OK else escape_cost) / max(int((labels == kind).sum()), 1)
    return found


def choose_thresholds(scores: Array, labels: NDArray[np.int64], beta: float = 2.0) -> Thresholds:
    """Thresholds of hole and missing weld with the best F-beta on a line; of those as good within 0.1 %, the middle one.

    An escape weighs beta squared times a false reject. Limits above 0.5 act as 0.5: what is not likelier OK is refused.
    """
    truth = labels != OK
    weights = line_weights(labels)[:, None]
    grid = THRESHOLDS
    hole = scores[:, HOLE, None] >= grid
    gone = scores[:, MISSING, None] >= grid
    sure = scores[:, OK] <= scores[:, 1:].max(axis=1)
    value = np.empty((grid.size, grid.size))
    for i in range(grid.size):
        nok = hole[:, i, None] | gone | sure[:, None]
        tp, fp = (weights * (nok & truth[:, None])).sum(axis=0), (weights * (nok & ~truth[:, None])).sum(axis=0)
        fn = (weights[:, 0] * truth).sum() - tp
        value[i] = (1 + beta**2) * tp / ((1 + beta**2) * tp + beta**2 * fn + fp)
    good = np.argwhere(value >= value.max() - 0.001)
    centre = np.median(good, axis=0)
    best = good[np.abs(good - centre).sum(axis=1).argmin()]
    return Thresholds(round(float(grid[best[0]]), 3), round(float(grid[best[1]]), 3))

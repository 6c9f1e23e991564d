"""Labelled parts and crops, judged through the classifier's file by the station's own code, as data."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import hypot
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.data.crops import IGNORED, OK, Crops
from models.data.labelled import label_of_arc
from models.data.lot import Defect, LabelledFrame, frames, read_labels
from models.evaluation.measures import decided
from models.evaluation.scores import class_scores, row_of
from station.classify.onnx import CLASSES, Classifier
from station.classify.thresholds import Thresholds
from station.defects import KINDS, Reason
from station.domain import SEGMENT_DEG, SEGMENTS, Inspection, Verdict
from station.inspection.inspector import Inspector
from station.vision.unwrap import segments, unwrap

WORST = 24
"""Number of crops on the contact sheet."""
LABEL_OF: dict[Reason | None, int] = {
    None: OK,
    **{kind.reason: label for label, kind in enumerate(KINDS, start=1)},
}
"""Label of each reason for which a segment may be rejected."""


@dataclass(frozen=True, slots=True)
class FoundDefect:
    """One true defect and whether any segment that shows it was rejected."""

    kind: str
    length_mm: float | None
    found: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class PartResult:
    """One judged part."""

    name: str
    truth: str
    verdict: str
    reason: str | None
    center_error_px: float | None
    radius_error_px: float | None
    novelty: float | None
    novel: bool
    defects: tuple[FoundDefect, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Worst:
    """A crop (128, 128) uint8 whose score is far from its truth."""

    name: str
    image: NDArray[np.uint8]
    label: int
    nok: float
    """Probability of NOK."""

    @property
    def wrongness(self) -> float:
        """Distance of the score from the truth, 0 to 1."""
        return self.nok if self.label == OK else 1 - self.nok


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Evaluation:
    """Result of an evaluation: the parts, and the crops with their scores, labels and decisions."""

    parts: tuple[PartResult, ...]
    """Empty if crops were judged."""
    scores: NDArray[np.float64]
    """(N, classes)"""
    labels: NDArray[np.int64]
    """What the crops show (N,), none of them IGNORED."""
    decided: NDArray[np.int64]
    """OK or the label for which each crop was rejected (N,)."""
    worst: tuple[Worst, ...]
    """The crops farthest from their truth, the farthest first."""
    unjudged: int = 0
    """Number of NOK segments on parts that ended in ERROR."""

    @property
    def nok(self) -> NDArray[np.bool_]:
        """True for each crop that was rejected (N,)."""
        return np.asarray(self.decided != OK, bool)

    def named(self, truth: str, verdict: str) -> list[str]:
        """Return the names of parts with that truth and verdict."""
        return [p.name for p in self.parts if p.truth == truth and p.verdict == verdict]


def evaluate_lot(lot: Path, inspector: Inspector, progress: Callable[[], None] = lambda: None) -> Evaluation:
    """Judge every frame of a lot. Raises LearningError before any frame is judged."""
    labels = read_labels(lot)
    for _ in frames(lot, labels):
        pass  # frames that cannot be read are reported before the work begins
    parts, crops = [], _Collected(inspector.um_per_px)
    for label, image in frames(lot, labels):
        judged = inspector.inspect(image)
        shown = [_label_of_segment(label.defects, i) for i in range(SEGMENTS)]
        crops.add(label.name, image, judged, shown)
        parts.append(_part(label, judged, inspector))
        progress()
    return crops.evaluation(tuple(parts))


def evaluate_crops(crops: Crops, classifier: Classifier, thresholds: Thresholds) -> Evaluation:
    """Judge crops as the station does with those of a strip."""
    scores = class_scores(classifier, crops.images)
    rows = zip(crops.names, crops.images, crops.labels, 1 - scores[:, OK], strict=True)
    worst = _farthest([Worst(str(name), image, int(label), float(nok)) for name, image, label, nok in rows])
    decisions = decided(scores, thresholds)
    return Evaluation(parts=(), scores=scores, labels=crops.labels, decided=decisions, worst=tuple(worst))


def _label_of_segment(defects: Sequence[Defect], index: int) -> int:
    return label_of_arc(defects, index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG)


def _farthest(crops: list[Worst]) -> list[Worst]:
    return sorted(crops, key=lambda crop: -crop.wrongness)[:WORST]


class _Collected:
    """Collects the judged segments; keeps only the images of the worst."""

    def __init__(self, um_per_px: float) -> None:
        self._um_per_px = um_per_px
        self._rows: list[tuple[tuple[float, ...], int, int]] = []
        self._worst: list[Worst] = []
        self._unjudged = 0

    def add(self, name: str, image: NDArray[np.uint8], judged: Inspection, labels: list[int]) -> None:
        """Add the segments of one part."""
        if judged.ring is None or not judged.scores:
            self._unjudged += sum(label > OK for label in labels)
            return
        images = segments(unwrap(image, judged.ring, um_per_px=self._um_per_px))
        rows = zip(judged.scores, labels, judged.rejected, strict=True)
        for index, (scores, label, reason) in enumerate(rows):
            if judged.invalid[index]:
                self._unjudged += label > OK
            elif label != IGNORED:
                self._rows.append((row_of(scores), label, LABEL_OF[reason]))
                self._worst.append(Worst(f"{name}, segment {index + 1}", images[index], label, scores.nok))
        self._worst = _farthest(self._worst)

    def evaluation(self, parts: tuple[PartResult, ...]) -> Evaluation:
        """Return all segments as an evaluation."""
        scores, labels, decisions = zip(*self._rows, strict=True) if self._rows else ((), (), ())
        return Evaluation(
            parts=parts,
            scores=np.array(scores, np.float64).reshape(-1, len(CLASSES)),
            labels=np.array(labels, np.int64),
            decided=np.array(decisions, np.int64),
            worst=tuple(self._worst),
            unjudged=self._unjudged,
        )


def _part(label: LabelledFrame, judged: Inspection, inspector: Inspector) -> PartResult:
    ring = judged.ring
    center_error_px = radius_error_px = None
    if ring is not None:
        center_error_px = hypot(ring.center_x_px - label.center_x_px, ring.center_y_px - label.center_y_px)
        radius_error_px = abs(ring.radius_px - label.radius_px)
    nok = judged.nok or (False,) * SEGMENTS
    found = []
    for defect in label.defects:
        shows = [i for i in range(SEGMENTS) if _label_of_segment((defect,), i) > OK]
        found.append(FoundDefect(CLASSES[defect.label], defect.length_mm, any(nok[i] for i in shows)))
    return PartResult(
        name=label.name,
        truth=label.verdict,
        verdict=str(Verdict(judged.verdict)),
        reason=None if judged.reason is None else str(judged.reason),
        center_error_px=center_error_px,
        radius_error_px=radius_error_px,
        novelty=judged.novelty,
        novel=inspector.is_novel(judged),
        defects=tuple(found),
    )

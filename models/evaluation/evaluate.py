"""Labelled parts and crops judged through the file and the station's own code, and what came out as data."""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.data.crops import IGNORED, OK, Crops
from models.data.labelled import defects_of, frames, label_of_arc, read_labels
from models.evaluation.measures import decided
from models.evaluation.scores import class_scores, row_of
from station.classify.onnx import CLASSES, Classifier
from station.classify.thresholds import Thresholds
from station.defects import KINDS, Reason
from station.domain import SEGMENT_DEG, SEGMENTS, Inspection, Verdict
from station.inspection.inspector import Inspector
from station.vision.unwrap import segments, unwrap

WORST = 24
"""Crops kept for the contact sheet."""
LABEL_OF: dict[Reason | None, int] = {
    None: OK,
    **{kind.reason: label for label, kind in enumerate(KINDS, start=1)},
}
"""Label of each reason for which a segment may be rejected."""


@dataclass(frozen=True, slots=True)
class Defect:
    """One true defect and whether any segment that shows it was refused."""

    kind: str
    length_mm: float | None
    found: bool


@dataclass(frozen=True, slots=True)
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
    defects: tuple[Defect, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Worst:
    """A crop (128, 128) uint8 that is far from its truth."""

    name: str
    image: NDArray[np.uint8]
    label: int
    nok: float
    """Its score of NOK."""

    @property
    def wrongness(self) -> float:
        """Distance to the truth, 0 to 1."""
        return self.nok if self.label == OK else 1 - self.nok


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """What came out: parts (none if crops were judged), and of each judged crop its score, label and decision.

    scores (N, classes); labels (N,) without IGNORED; decided (N,), OK or the label for which the crop was rejected;
    `worst`: farthest from their truth first; `unjudged`: number of NOK segments on parts that ended in ERROR.
    """

    parts: tuple[PartResult, ...]
    scores: NDArray[np.float64]
    labels: NDArray[np.int64]
    decided: NDArray[np.int64]
    worst: tuple[Worst, ...]
    unjudged: int = 0

    @property
    def nok(self) -> NDArray[np.bool_]:
        """True for each crop that was rejected (N,)."""
        return self.decided != OK

    def named(self, truth: str, verdict: str) -> list[str]:
        """Names of parts with that truth and verdict."""
        return [p.name for p in self.parts if p.truth == truth and p.verdict == verdict]


def evaluate_lot(lot: Path, inspector: Inspector, progress: Callable[[], None] = lambda: None) -> Evaluation:
    """Judge every frame of a lot. Raises LearningError before any frame is judged."""
    items = read_labels(lot)
    for _ in frames(lot, items):
        pass  # what cannot be read is told before the work begins
    parts, crops = [], _Collected()
    for item, image in frames(lot, items):
        judged = inspector.inspect(image)
        defects = defects_of(item)
        labels = [label_of_arc(defects, i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG) for i in range(SEGMENTS)]
        nok = list(judged.nok) or [False] * SEGMENTS
        crops.add(str(item["frame"]), image, judged, labels)
        parts.append(_part(item, judged, nok, inspector))
        progress()
    return crops.evaluation(tuple(parts))


def evaluate_crops(crops: Crops, classifier: Classifier, thresholds: Thresholds) -> Evaluation:
    """Judge crops, as the station does with those of a strip."""
    scores = class_scores(classifier, crops.images)
    rows = zip(crops.names, crops.images, crops.labels, 1 - scores[:, OK], strict=True)
    worst = _farthest([Worst(str(name), image, int(label), float(nok)) for name, image, label, nok in rows])
    return Evaluation((), scores, crops.labels, decided(scores, thresholds), tuple(worst))


def _farthest(crops: list[Worst]) -> list[Worst]:
    return sorted(crops, key=lambda crop: -crop.wrongness)[:WORST]


class _Collected:
    """Segments as they come; of their pictures only the worst are kept."""

    def __init__(self) -> None:
        self._rows: list[tuple[tuple[float, ...], int, int]] = []
        self._worst: list[Worst] = []
        self._unjudged = 0

    def add(self, name: str, image: NDArray[np.uint8], judged: Inspection, labels: list[int]) -> None:
        """The segments of one part."""
        if judged.ring is None or not judged.scores:
            self._unjudged += sum(label > OK for label in labels)
            return
        pictures = segments(unwrap(image, judged.ring))
        for index, (s, label, reason) in enumerate(zip(judged.scores, labels, judged.rejected, strict=True)):
            if label != IGNORED:
                self._rows.append((row_of(s), label, LABEL_OF[reason]))
                self._worst.append(Worst(f"{name}, segment {index + 1}", pictures[index], label, s.nok))
        self._worst = _farthest(self._worst)

    def evaluation(self, parts: tuple[PartResult, ...]) -> Evaluation:
        """All of them."""
        scores, labels, decisions = zip(*self._rows, strict=True) if self._rows else ((), (), ())
        return Evaluation(
            parts,
            np.array(scores, np.float64).reshape(-1, len(CLASSES)),
            np.array(labels, np.int64),
            np.array(decisions, np.int64),
            tuple(self._worst),
            self._unjudged,
        )


def _part(item: dict[str, Any], judged: Inspection, nok: list[bool], inspector: Inspector) -> PartResult:
    x, y = item["center"]
    ring = judged.ring
    found = []
    for defect, entry in zip(defects_of(item), item["defects"], strict=True):
        on = [
            i for i in range(SEGMENTS) if label_of_arc((defect,), i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG) > OK
        ]
        kind = CLASSES[defect.label]
        length = entry.get("length_mm")
        found.append(Defect(kind, None if length is None else float(length), any(nok[i] for i in on)))
    return PartResult(
        name=str(item["frame"]),
        truth=str(item["verdict"]),
        verdict=str(Verdict(judged.verdict)),
        reason=None if judged.reason is None else str(judged.reason),
        center_error_px=None if ring is None else hypot(ring.center_x_px - x, ring.center_y_px - y),
        radius_error_px=None if ring is None else abs(ring.radius_px - item["radius"]),
        novelty=judged.novelty,
        novel=inspector.is_novel(judged),
        defects=tuple(found),
    )

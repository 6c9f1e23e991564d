"""Labelled parts and crops judged through the file and the station's own code, and what came out as data."""

from collections.abc import Callable
from dataclasses import dataclass
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.crops import HOLE, IGNORED, OK, Crops
from models.errors import LearningError, listed
from models.labelled import crop_label, defects_of, read_labels
from station.classify.onnx import CLASSES, Classifier
from station.domain import SEGMENT_DEG, SEGMENTS, Inspection, Verdict
from station.errors import ImageError
from station.imagefile import read_image
from station.inspection import Inspector
from station.vision.unwrap import segments, unwrap

KEPT_CROPS = 2000
"""Crops kept for the contact sheet."""
BATCH = 256


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
class Evaluation:
    """What came out: parts (none if crops were judged), and of each judged crop its score, label and decision.

    scores (N, 3), labels (N,) without IGNORED, nok (N,); `unjudged` NOK segments lie on parts that ended in ERROR; images (N, 128, 128)
    uint8 or none if there are too many to keep.
    """

    parts: tuple[PartResult, ...]
    scores: NDArray[np.float64]
    labels: NDArray[np.int64]
    nok: NDArray[np.bool_]
    names: tuple[str, ...]
    images: NDArray[np.uint8] | None
    unjudged: int = 0

    def named(self, truth: str, verdict: str) -> list[str]:
        """Names of parts with that truth and verdict."""
        return [p.name for p in self.parts if p.truth == truth and p.verdict == verdict]


def evaluate_lot(lot: Path, inspector: Inspector, progress: Callable[[], None] = lambda: None) -> Evaluation:
    """Judge every frame of a lot. Raises LearningError before any frame is judged, ImageError."""
    items = read_labels(lot)
    wrong = [problem for item in items if (problem := _unreadable(lot / "frames" / str(item["frame"])))]
    if wrong:
        raise LearningError(listed(lot, wrong))
    parts, crops = [], _Collected()
    for item in items:
        image = read_image(lot / "frames" / str(item["frame"]))
        judged = inspector.inspect(image)
        defects = defects_of(item)
        labels = [crop_label(defects, i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG) for i in range(SEGMENTS)]
        refused = [i < len(judged.scores) and inspector.is_nok(judged.scores[i]) for i in range(SEGMENTS)]
        crops.add(str(item["frame"]), image, judged, labels, refused)
        parts.append(_part(item, judged, refused, inspector))
        progress()
    return crops.evaluation(tuple(parts))


def evaluate_crops(crops: Crops, classifier: Classifier, is_nok: Callable[[Any], bool]) -> Evaluation:
    """Judge crops, as the station does with those of a strip."""
    scores = [s for i in range(0, len(crops), BATCH) for s in classifier(crops.images[i : i + BATCH]).scores]
    return Evaluation(
        (),
        np.array([(s.ok, s.hole, s.missing_weld) for s in scores]),
        crops.labels,
        np.array([is_nok(s) for s in scores]),
        tuple(map(str, crops.names)),
        crops.images if len(crops) <= KEPT_CROPS else None,
    )


def _unreadable(path: Path) -> str | None:
    try:
        read_image(path)
    except ImageError as error:
        return str(error)
    return None


class _Collected:
    """Segments as they come."""

    def __init__(self) -> None:
        self._rows: list[tuple[str, tuple[float, float, float], int, bool]] = []
        self._images: list[NDArray[np.uint8]] = []
        self._unjudged = 0

    def add(self, name: str, image: NDArray[np.uint8], judged: Inspection, labels: list[int], refused: list[bool]) -> None:
        """The segments of one part."""
        if judged.ring is None or not judged.scores:
            self._unjudged += sum(label > OK for label in labels)
            return
        pictures = segments(unwrap(image, judged.ring)) if len(self._rows) < KEPT_CROPS else None
        for index, (s, label, nok) in enumerate(zip(judged.scores, labels, refused, strict=True)):
            if label != IGNORED:
                self._rows.append((f"{name}, segment {index + 1}", (s.ok, s.hole, s.missing_weld), label, nok))
                if pictures is not None:
                    self._images.append(pictures[index])

    def evaluation(self, parts: tuple[PartResult, ...]) -> Evaluation:
        """All of them."""
        names, scores, labels, nok = zip(*self._rows, strict=True) if self._rows else ((), (), (), ())
        return Evaluation(
            parts,
            np.array(scores, np.float64).reshape(-1, len(CLASSES)),
            np.array(labels, np.int64),
            np.array(nok, bool),
            tuple(names),
            np.stack(self._images) if self._images and len(self._images) == len(self._rows) else None,
            self._unjudged,
        )


def _part(item: dict[str, Any], judged: Inspection, refused: list[bool], inspector: Inspector) -> PartResult:
    x, y = item["center"]
    ring = judged.ring
    found = []
    for defect, entry in zip(defects_of(item), item["defects"], strict=True):
        on = [i for i in range(SEGMENTS) if crop_label((defect,), i * SEGMENT_DEG, (i + 1) * SEGMENT_DEG) > OK]
        kind = CLASSES[HOLE] if defect.label == HOLE else CLASSES[-1]
        length = entry.get("length_mm")
        found.append(Defect(kind, None if length is None else float(length), any(refused[i] for i in on)))
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

"""Boxes of the defect map, and how good they are (the paper's second model): COCO's average precision at an overlap of 50 %.

The boxes are the edges of the map's areas: one network classifies and locates, so that no box contradicts a verdict.
"""

import contextlib
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.data.crops import CHANNELS, OK, Crops
from models.errors import LearningError
from models.evaluation.measures import Counts, count
from station.classify.extent import CELL_PX, CELLS, LEVEL, Map, extents
from station.classify.onnx import CLASSES, Classifier, Judged
from station.defects import DefectKind

BATCH = 256
PAD = 3
"""Empty cells on both sides, so that an area does not close over the borders of a single crop."""
UM_PER_PX = 13.0
MAX_SIDE = CELLS * CELL_PX


@dataclass(frozen=True, slots=True)
class Box:
    """One detected defect: `kind` by name, left, top, width, height in px, score 0..1."""

    kind: str
    box_px: tuple[float, float, float, float]
    score: float


@dataclass(frozen=True, slots=True)
class Detection:
    """How good the boxes are."""

    map50: float
    by_kind: dict[str, float]
    as_decision: Counts
    """OK / NOK, by whether there is any box."""


def boxes(maps: Map, probabilities: Mapping[DefectKind, float]) -> list[Box]:
    """Return the boxes of one crop's map (C, 32, 32), scored by the `probabilities` of its C kinds, in the order of the channels."""
    found = []
    for values, (kind, probability) in zip(maps, probabilities.items(), strict=True):
        padded = np.pad(values, ((0, 0), (PAD, PAD)))
        for extent in extents(padded, kind.joins_mm * 1000 / UM_PER_PX):
            left, right = (
                float(np.clip(v - PAD * CELL_PX, 0, MAX_SIDE)) for v in (extent.start_px, extent.end_px)
            )
            top, bottom = (float(np.clip(v, 0, MAX_SIDE)) for v in (extent.top_px, extent.bottom_px))
            if right > left and bottom > top:
                score = extent.peak * probability
                found.append(Box(kind.name, (left, top, right - left, bottom - top), score))
    return found


def evaluate_boxes(
    folders: Sequence[Path], held: Crops, classifier: Classifier, kinds: Sequence[int]
) -> Detection:
    """Boxes of the held-out crops of rendered datasets against their `coco_val.json`; `kinds` are the classes looked for."""
    from pycocotools.cocoeval import COCOeval

    truth = _truth(folders)
    numbers = {image["path"]: image["id"] for image in truth.dataset["images"]}
    results: list[dict[str, Any]] = []
    names = [CLASSES[kind] for kind in kinds if CLASSES[kind] in CHANNELS]
    nok = np.zeros(len(held), bool)
    for start in range(0, len(held), BATCH):
        judged = classifier(held.images[start : start + BATCH])
        for offset, found in enumerate(_all(judged)):
            for box in found:
                nok[start + offset] |= box.score >= LEVEL and box.kind in names
                results.append(
                    {
                        "image_id": numbers[str(held.names[start + offset])],
                        "category_id": CHANNELS.index(box.kind) + 1,
                        "bbox": list(box.box_px),
                        "score": box.score,
                    }
                )
    precision = {}
    for name in names:
        with contextlib.redirect_stdout(io.StringIO()):
            scored = COCOeval(truth, truth.loadRes(results) if results else truth.loadRes([]), "bbox")
            scored.params.catIds = [CHANNELS.index(name) + 1]
            scored.evaluate()
            scored.accumulate()
            scored.summarize()
        precision[name] = float(scored.stats[1])
    return Detection(float(np.mean(list(precision.values()))), precision, count(nok, held.labels != OK))


def _all(judged: Judged) -> list[list[Box]]:
    pairs = zip(judged.maps, judged.scores, strict=True)
    return [boxes(maps, {kind: s.defects[kind] for kind in judged.mapped}) for maps, s in pairs]


def _truth(folders: Sequence[Path]) -> Any:
    """The datasets' annotations as one."""
    from pycocotools.coco import COCO

    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    categories: list[dict[str, Any]] = []
    for folder in folders:
        with contextlib.redirect_stdout(io.StringIO()):
            try:
                one = COCO(str(folder / "coco_val.json"))
            except (OSError, ValueError) as error:
                raise LearningError(
                    f"{folder / 'coco_val.json'}: not readable ({error}); make the dataset again"
                ) from None
        first = len(images)
        categories = one.dataset["categories"]
        images += [
            {**i, "id": i["id"] + first, "path": str(folder / i["file_name"])} for i in one.dataset["images"]
        ]
        annotations += [{**a, "image_id": a["image_id"] + first} for a in one.dataset["annotations"]]
    joined = COCO()
    joined.dataset = {
        "info": {},
        "images": images,
        "annotations": [{**a, "id": i} for i, a in enumerate(annotations, 1)],
        "categories": categories,
    }
    with contextlib.redirect_stdout(io.StringIO()):
        joined.createIndex()
    return joined

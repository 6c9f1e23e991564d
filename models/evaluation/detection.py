"""Boxes of the defect map, and how good they are: COCO's average precision at an overlap of 50 %.

They correspond to the paper's second model. The boxes are the edges of the map's areas: one network
classifies and locates, so that no box contradicts a verdict.
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
from station.domain import NETWORK_UM_PER_PX

BATCH = 256
PAD = 3
"""Empty cells on both sides, so that an area does not close over the borders of a single crop."""
MAX_SIDE = CELLS * CELL_PX
Row = dict[str, Any]
"""An image, an annotation or a category in COCO's format."""


@dataclass(frozen=True, slots=True)
class Box:
    """One detected defect: name of its kind; left, top, width and height in px; score 0..1."""

    kind: str
    box_px: tuple[float, float, float, float]
    score: float


@dataclass(frozen=True, slots=True)
class Detection:
    """How good the boxes are."""

    map50: float
    """Mean of `by_kind`."""
    by_kind: dict[str, float]
    """Average precision at an overlap of 50 %, by name of the kind."""
    as_decision: Counts
    """OK or NOK, by whether there is any box."""


def boxes(maps: Map, probabilities: Mapping[DefectKind, float]) -> list[Box]:
    """Return the boxes of one crop's map (C, 32, 32).

    `probabilities` are those of the map's C kinds, in the order of its channels; they scale the scores.
    """
    found = []
    for values, (kind, probability) in zip(maps, probabilities.items(), strict=True):
        padded = np.pad(values, ((0, 0), (PAD, PAD)))
        for extent in extents(padded, kind.joins_mm * 1000 / NETWORK_UM_PER_PX):
            left, right = (
                float(np.clip(v - PAD * CELL_PX, 0, MAX_SIDE)) for v in (extent.start_px, extent.end_px)
            )
            top, bottom = (float(np.clip(v, 0, MAX_SIDE)) for v in (extent.top_px, extent.bottom_px))
            if right > left and bottom > top:
                box = (left, top, right - left, bottom - top)
                found.append(Box(kind.name, box, extent.peak * probability))
    return found


def evaluate_boxes(
    folders: Sequence[Path], held_out: Crops, classifier: Classifier, kinds: Sequence[int]
) -> Detection:
    """Compare the boxes of the held-out crops of datasets with the datasets' `coco_val.json`.

    `kinds` are the labels looked for; those without a channel in the defect map, or without a defect in the
    data, are left out. Raises LearningError if none is left.
    """
    truth = _truth(folders)
    shown = {annotation["category_id"] for annotation in truth.dataset["annotations"]}
    names = [name for name in CHANNELS if CLASSES.index(name) in kinds and _category(name) in shown]
    if not names:
        asked = ", ".join(CLASSES[label] for label in kinds)
        raise LearningError(
            f"no boxes of {asked} in the data. Name kinds that it shows and that have a defect map"
        )
    numbers = {image["path"]: image["id"] for image in truth.dataset["images"]}
    results: list[Row] = []
    nok = np.zeros(len(held_out), bool)
    for start in range(0, len(held_out), BATCH):
        judged = classifier(held_out.images[start : start + BATCH])
        for place, found in enumerate(_boxes_of(judged), start):
            for box in found:
                nok[place] |= box.score >= LEVEL and box.kind in names
                result = {"category_id": _category(box.kind), "bbox": list(box.box_px), "score": box.score}
                results.append({"image_id": numbers[str(held_out.names[place])], **result})
    precision = {name: _average_precision(truth, results, name) for name in names}
    # a kind without a channel can have no box
    mapped = ~np.isin(held_out.labels, [CLASSES.index(name) for name in CLASSES[1:] if name not in CHANNELS])
    decisions = count(nok[mapped], held_out.labels[mapped] != OK)
    return Detection(float(np.mean(list(precision.values()))), precision, decisions)


def _category(kind: str) -> int:
    """Return the number of a kind of defect in COCO's format, whatever number a dataset gives it."""
    return CHANNELS.index(kind) + 1


def _boxes_of(judged: Judged) -> list[list[Box]]:
    pairs = zip(judged.maps, judged.scores, strict=True)
    return [boxes(maps, {kind: scores.defects[kind] for kind in judged.mapped}) for maps, scores in pairs]


def _average_precision(truth: Any, results: list[Row], name: str) -> float:
    from pycocotools.cocoeval import COCOeval

    if not results:
        return 0.0
    with contextlib.redirect_stdout(io.StringIO()):
        scored = COCOeval(truth, truth.loadRes(results), "bbox")
        scored.params.catIds = [_category(name)]
        scored.evaluate()
        scored.accumulate()
        scored.summarize()
    return float(scored.stats[1])


def _truth(folders: Sequence[Path]) -> Any:
    """Return the datasets' annotations as one."""
    from pycocotools.coco import COCO

    images: list[Row] = []
    annotations: list[Row] = []
    for folder in folders:
        path = folder / "coco_val.json"
        with contextlib.redirect_stdout(io.StringIO()):
            try:
                one = COCO(str(path))
            except (OSError, ValueError) as error:
                raise LearningError(f"{path}: not readable ({error}). Make the dataset again") from None
        first = len(images)
        images += [
            {**i, "id": i["id"] + first, "path": str(folder / i["file_name"])} for i in one.dataset["images"]
        ]
        annotations += [{**a, "image_id": a["image_id"] + first} for a in _of_mapped_kinds(path, one.dataset)]
    joined = COCO()
    joined.dataset = {
        "info": {},
        "images": images,
        "annotations": [{**a, "id": i} for i, a in enumerate(annotations, 1)],
        "categories": [{"id": _category(name), "name": name} for name in CHANNELS],
    }
    with contextlib.redirect_stdout(io.StringIO()):
        joined.createIndex()
    return joined


def _of_mapped_kinds(path: Path, dataset: dict[str, list[Row]]) -> list[Row]:
    """Return the annotations of kinds with a channel, under our numbers.

    Raises LearningError for an unknown kind.
    """
    names = {category["id"]: str(category["name"]) for category in dataset["categories"]}
    unknown = sorted(set(names.values()) - set(CLASSES))
    if unknown:
        raise LearningError(f"{path}: unknown kind of defect {', '.join(unknown)}. Make the dataset again")
    rows = [(row, names[row["category_id"]]) for row in dataset["annotations"]]
    return [{**row, "category_id": _category(name)} for row, name in rows if name in CHANNELS]

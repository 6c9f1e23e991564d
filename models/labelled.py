"""Labelled parts to strips and crops, through the station's own unwrap.

A lot is a folder with `labels.json` (what `weldgate-synth part` writes) and `frames/`.
"""

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from models.errors import LearningError
from station.classify.onnx import CLASSES
from station.domain import SEGMENT_DEG, SEGMENT_PX, STRIP_COLUMNS, Ring
from station.vision.unwrap import unwrap

OK, HOLE, MISSING = range(3)
IGNORED = -1
MIN_OVERLAP = 0.2
"""A crop is NOK if a defect covers this share of the smaller of crop and defect; below, but not 0, it is ignored."""


@dataclass(frozen=True, slots=True)
class Defect:
    """Arc of a defect, degrees, end may exceed 360."""

    label: int
    start_deg: float
    end_deg: float


@dataclass(frozen=True, slots=True, eq=False)
class LabelledStrip:
    """One unwrapped part: strip (128, 2688) uint8 and its defects."""

    part: str
    strip: NDArray[np.uint8]
    defects: tuple[Defect, ...]

    def crop(self, column: int) -> tuple[NDArray[np.uint8], int]:
        """Crop (128, 128) that starts at `column` (wraps round) and its label, `IGNORED` included."""
        columns = np.arange(column, column + SEGMENT_PX) % STRIP_COLUMNS
        start = column * 360.0 / STRIP_COLUMNS
        return self.strip[:, columns], crop_label(self.defects, start, start + SEGMENT_DEG)


def crop_label(defects: tuple[Defect, ...], start_deg: float, end_deg: float) -> int:
    """Class of the arc [start, end]: a missing weld weighs more than a hole, any defect more than IGNORED."""
    label, touched = OK, False
    width = end_deg - start_deg
    for defect in defects:
        length = defect.end_deg - defect.start_deg
        turns = (0.0,) if length >= 360 else (-720.0, -360.0, 0.0, 360.0)
        if length >= 360:
            overlap = width
        else:
            overlap = sum(max(0.0, min(defect.end_deg + k, end_deg) - max(defect.start_deg + k, start_deg)) for k in turns)
        if overlap / max(min(width, length), 1e-9) >= MIN_OVERLAP:
            label = max(label, defect.label)
        elif overlap > 0:
            touched = True
    return IGNORED if label == OK and touched else label


def read_lot(folder: Path, jitters: int, rng: np.random.Generator, progress: Callable[[], None] = lambda: None) -> list[LabelledStrip]:
    """Strips of all parts: one with the true ring and `jitters` more with the ring moved by a few pixels.

    Raises LearningError listing what is wrong, before any strip is cut.
    """
    labels = read_labels(folder)
    strips = []
    for item in labels:
        image = cv2.imread(str(folder / "frames" / item["frame"]), cv2.IMREAD_GRAYSCALE)
        if image is None:
            raise LearningError(f"{folder / 'frames' / item['frame']}: not a readable image")
        defects = defects_of(item)
        for index in range(1 + jitters):
            dx, dy, dr = rng.uniform(-4, 4, 3) if index else (0.0, 0.0, 0.0)
            ring = Ring(item["center"][0] + dx, item["center"][1] + dy, item["radius"] + dr, 1.0)
            strips.append(LabelledStrip(item["frame"], unwrap(np.asarray(image, np.uint8), ring), defects))
        progress()
    return strips


def read_images(folder: Path) -> list[tuple[NDArray[np.uint8], float, float, float]]:
    """Images of a lot with the true circle: (image, centre x, centre y, radius), px. Raises LearningError."""
    found = []
    for item in read_labels(folder):
        image = cv2.imread(str(folder / "frames" / str(item["frame"])), cv2.IMREAD_GRAYSCALE)
        if image is None:
            raise LearningError(f"{folder / 'frames' / str(item['frame'])}: not a readable image")
        found.append((np.asarray(image, np.uint8), float(item["center"][0]), float(item["center"][1]), float(item["radius"])))
    return found


def data_hash(folders: list[Path]) -> str:
    """SHA-256 over the labels and the images of lots, images in the order of their names."""
    digest = hashlib.sha256()
    for folder in folders:
        digest.update((folder / "labels.json").read_bytes())
        for path in sorted((folder / "frames").glob("*.png")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def split_by_part(strips: list[LabelledStrip], share: float) -> tuple[list[LabelledStrip], list[LabelledStrip]]:
    """Training and validation strips: all strips of one part on one side, every n-th of the parts held out."""
    parts = sorted({s.part for s in strips})
    every = max(1, round(1 / share))
    held = set(parts[every - 1 :: every])
    return [s for s in strips if s.part not in held], [s for s in strips if s.part in held]


def read_labels(folder: Path) -> list[dict[str, Any]]:
    """Entries of `labels.json`. Raises LearningError if any is wrong or its image is missing."""
    path = folder / "labels.json"
    try:
        labels = json.loads(path.read_text())["frames"]
    except FileNotFoundError:
        raise LearningError(f"{path}: no such file; render a lot first with weldgate-synth part --out {folder}") from None
    except (ValueError, KeyError, TypeError):
        raise LearningError(f"{path}: not a labels file") from None
    absent = [item["frame"] for item in labels if not (folder / "frames" / item["frame"]).is_file()]
    if absent:
        raise LearningError(f"{path}: {len(absent)} images are missing: {', '.join(absent[:5])}")
    unknown = {d["kind"] for item in labels for d in item["defects"]} - {"hole_small", "hole_long", "missing_weld"}
    if unknown:
        raise LearningError(f"{path}: unknown kinds {sorted(unknown)}; known: hole_small, hole_long, missing_weld")
    return list(labels)


def defects_of(item: dict[str, Any]) -> tuple[Defect, ...]:
    """Defects of one labelled part."""
    return tuple(_defect(d) for d in item["defects"])


def _defect(item: dict[str, Any]) -> Defect:
    start, end = item["angle_deg"]
    return Defect(CLASSES.index("missing_weld") if item["kind"] == "missing_weld" else CLASSES.index("hole"), start, end)

"""Datasets made by `weldgate-synth dataset`, read as crops; each is checked completely before it is used."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from models.data.crops import CHANNELS, DEFECTS, OK, Crops, coarse, empty_maps, join
from models.errors import LearningError, listed
from station.classify.onnx import CLASSES
from station.domain import SEGMENT_PX

SPLITS = ("train", "val")
"""Folders of the training crops and of the held-out crops."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Entry:
    """One crop in manifest.json."""

    file: str
    kind: str
    sha256: str
    seed: int
    outlines: tuple[tuple[str, list[list[int]]], ...]
    """Kind of each defect and its polygons, px: x1, y1, x2, y2, ..."""


def read_rendered(folders: Sequence[Path], kinds: Sequence[int] = DEFECTS) -> tuple[Crops, Crops, str]:
    """Read the training crops, the held-out crops and the SHA-256 of the images of one or more datasets.

    Both need OK crops and crops of each of `kinds` (labels), or of any kind if none is named. Raises
    LearningError listing every file that is missing, altered, unreadable, of the wrong size or in the folder
    of another kind.
    """
    digest = hashlib.sha256()
    sides: dict[str, list[Crops]] = {split: [] for split in SPLITS}
    for folder in folders:
        entries = _entries(folder)
        for split in SPLITS:
            sides[split].append(_read(folder, [e for e in entries if e.file.startswith(f"images/{split}/")]))
        digest.update("".join(f"{e.file} {e.sha256}\n" for e in entries).encode())
    training, held_out = (join(sides[split]) for split in SPLITS)
    for split, crops in zip(SPLITS, (training, held_out), strict=True):
        if problem := _lacking(crops, kinds):
            raise LearningError(f"{', '.join(map(str, folders))}: images/{split} {problem}")
    return training, held_out, digest.hexdigest()


def _lacking(crops: Crops, kinds: Sequence[int]) -> str | None:
    """Return what crops lack to be learned from."""
    absent = [CLASSES[label] for label in (OK, *kinds) if not crops.count(label)]
    if not absent and not any(crops.count(label) for label in DEFECTS):
        absent = ["defect"]
    if absent:
        return f"shows no {', '.join(absent)}. Render more crops"
    for channel, name in enumerate(CHANNELS):
        shown = crops.labels == CLASSES.index(name)
        if shown.any() and not crops.maps[shown, channel].any():
            return f"outlines none of its {int(shown.sum())} crops of {name}. Make the dataset again"
    return None


def _entries(folder: Path) -> list[_Entry]:
    path = folder / "manifest.json"
    try:
        entries = [_entry(item) for item in json.loads(path.read_text(encoding="utf-8"))["images"]]
    except FileNotFoundError:
        hint = f"Make or finish a dataset with weldgate-synth dataset --out {folder}"
        raise LearningError(f"{path}: no such file. {hint}") from None
    except (ValueError, KeyError, TypeError):
        hint = "Make one with weldgate-synth dataset"
        raise LearningError(f"{path}: not the manifest of a dataset. {hint}") from None
    known = {e.file for e in entries}
    wrong = [
        f"{e.file}: the manifest calls it {e.kind}" for e in entries if e.kind != Path(e.file).parent.name
    ]
    wrong += [f"{e.file}: unknown kind" for e in entries if e.kind not in CLASSES]
    outlined = [(e.file, name) for e in entries for name, _ in e.outlines]
    wrong += [f"{file}: outline of unknown kind {name}" for file, name in outlined if name not in CLASSES[1:]]
    wrong += [f"{e.file}: missing" for e in entries if not (folder / e.file).is_file()]
    files = (p for p in sorted((folder / "images").rglob("*")) if p.is_file())
    found = (path.relative_to(folder).as_posix() for path in files)
    wrong += [f"{name}: not in the manifest" for name in found if name not in known]
    if wrong:
        raise LearningError(listed(folder, wrong))
    return entries


def _entry(item: dict) -> _Entry:  # type: ignore[type-arg] # any JSON
    return _Entry(
        file=str(item["file"]),
        kind=str(item["kind"]),
        sha256=str(item["sha256"]),
        seed=int(item["seed"]),
        outlines=tuple((str(defect["kind"]), list(defect["polygon_px"])) for defect in item["defects"]),
    )


def _read(folder: Path, entries: list[_Entry]) -> Crops:
    images = np.empty((len(entries), SEGMENT_PX, SEGMENT_PX), np.uint8)
    maps = empty_maps(len(entries))
    wrong = []
    for index, entry in enumerate(entries):
        content = (folder / entry.file).read_bytes()
        image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED) if content else None
        if image is None:
            wrong.append(f"{entry.file}: not a readable image")
        elif image.shape != (SEGMENT_PX, SEGMENT_PX) or image.dtype != np.uint8:
            size, needed = " x ".join(map(str, image.shape[1::-1])), f"{SEGMENT_PX} x {SEGMENT_PX}"
            wrong.append(f"{entry.file}: {size} px {image.dtype}, needed {needed} px uint8, one channel")
        elif hashlib.sha256(content).hexdigest() != entry.sha256:
            wrong.append(f"{entry.file}: differs from the manifest")
        else:
            images[index] = image
            for name, polygons in entry.outlines:
                if name in CHANNELS:
                    channel = CHANNELS.index(name)
                    maps[index, channel] = np.maximum(maps[index, channel], coarse(_mask(polygons)))
    if wrong:
        raise LearningError(listed(folder, wrong))
    return Crops(
        images=images,
        labels=np.array([CLASSES.index(e.kind) for e in entries], np.int64),
        maps=maps,
        mapped=np.ones(len(entries), bool),
        parts=np.array([f"{folder}:{e.seed}" for e in entries], np.str_),
        names=np.array([str(folder / e.file) for e in entries], np.str_),
    )


def _mask(polygons: list[list[int]]) -> NDArray[np.bool_]:
    mask = np.zeros((SEGMENT_PX, SEGMENT_PX), np.uint8)
    cv2.fillPoly(mask, [np.array(p, np.int32).reshape(-1, 1, 2) for p in polygons], 1)
    return mask.astype(bool)

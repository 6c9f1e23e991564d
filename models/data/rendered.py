"""Datasets of `weldgate-synth dataset` as crops; checked whole before anything is done with them."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from models.data.crops import CHANNELS, Crops, coarse, empty_maps, join
from models.errors import LearningError, listed
from station.classify.onnx import CLASSES
from station.domain import SEGMENT_PX

SPLITS = ("train", "val")


def read_rendered(folders: Sequence[Path]) -> tuple[Crops, Crops, str]:
    """Training crops, held-out crops and the SHA-256 of what they are, of one or more datasets.

    Raises LearningError listing all files that are missing, altered, unreadable, of the wrong size or in the folder of another kind.
    """
    digest = hashlib.sha256()
    sides: dict[str, list[Crops]] = {split: [] for split in SPLITS}
    for folder in folders:
        entries = _entries(folder)
        for split in SPLITS:
            sides[split].append(
                _read(folder, [e for e in entries if e["file"].startswith(f"images/{split}/")])
            )
        digest.update("".join(f"{e['file']} {e['sha256']}\n" for e in entries).encode())
    training, held = (join(sides[split]) for split in SPLITS)
    for split, crops in zip(SPLITS, (training, held), strict=True):
        lacking = [name for label, name in enumerate(CLASSES) if not crops.count(label)]
        if lacking:
            raise LearningError(
                f"{', '.join(map(str, folders))}: images/{split} shows no {', '.join(lacking)}; render more crops"
            )
    return training, held, digest.hexdigest()


def _entries(folder: Path) -> list[dict[str, Any]]:
    path = folder / "manifest.json"
    try:
        entries = json.loads(path.read_text(encoding="utf-8"))["images"]
        listing = [
            {"file": str(e["file"]), "kind": str(e["kind"]), "sha256": str(e["sha256"]), **e} for e in entries
        ]
    except FileNotFoundError:
        raise LearningError(
            f"{path}: no such file; make or finish a dataset with weldgate-synth dataset --out {folder}"
        ) from None
    except (ValueError, KeyError, TypeError):
        raise LearningError(
            f"{path}: not the manifest of a dataset; make one with weldgate-synth dataset"
        ) from None
    wrong = [
        f"{e['file']}: the manifest calls it {e['kind']}"
        for e in listing
        if e["kind"] != Path(e["file"]).parent.name
    ]
    wrong += [f"{e['file']}: unknown kind" for e in listing if e["kind"] not in CLASSES]
    wrong += [f"{e['file']}: missing" for e in listing if not (folder / e["file"]).is_file()]
    known = {e["file"] for e in listing}
    found = (p.relative_to(folder).as_posix() for p in sorted((folder / "images").rglob("*")) if p.is_file())
    wrong += [f"{name}: not in the manifest" for name in found if name not in known]
    if wrong:
        raise LearningError(listed(folder, wrong))
    return listing


def _read(folder: Path, entries: list[dict[str, Any]]) -> Crops:
    images = np.empty((len(entries), SEGMENT_PX, SEGMENT_PX), np.uint8)
    maps = empty_maps(len(entries))
    wrong = []
    for index, entry in enumerate(entries):
        content = (folder / entry["file"]).read_bytes()
        image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED) if content else None
        if image is None:
            wrong.append(f"{entry['file']}: not a readable image")
        elif image.shape != (SEGMENT_PX, SEGMENT_PX) or image.dtype != np.uint8:
            size = " x ".join(map(str, image.shape[1::-1]))
            wrong.append(
                f"{entry['file']}: {size} px {image.dtype}, needed {SEGMENT_PX} x {SEGMENT_PX} px uint8, one channel"
            )
        elif hashlib.sha256(content).hexdigest() != entry["sha256"]:
            wrong.append(f"{entry['file']}: differs from the manifest")
        else:
            images[index] = image
            for defect in entry["defects"]:
                if defect["kind"] in CHANNELS:
                    channel = CHANNELS.index(defect["kind"])
                    maps[index, channel] = np.maximum(
                        maps[index, channel], coarse(_mask(defect["polygon_px"]))
                    )
    if wrong:
        raise LearningError(listed(folder, wrong))
    return Crops(
        images=images,
        labels=np.array([CLASSES.index(e["kind"]) for e in entries], np.int64),
        maps=maps,
        mapped=np.ones(len(entries), bool),
        parts=np.array([f"{folder}:{e['seed']}" for e in entries], np.str_),
        names=np.array([str(folder / e["file"]) for e in entries], np.str_),
    )


def _mask(polygons: list[list[int]]) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    mask = np.zeros((SEGMENT_PX, SEGMENT_PX), np.uint8)
    cv2.fillPoly(mask, [np.array(p, np.int32).reshape(-1, 1, 2) for p in polygons], 1)
    return mask.astype(bool)

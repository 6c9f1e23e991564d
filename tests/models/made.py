"""Small datasets and lots made in code: discs on stripes, so that a network can learn them in seconds."""

import hashlib
import json
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from models.data.crops import CHANNELS, Crops, coarse, empty_maps
from station.classify.onnx import CLASSES

KINDS = CLASSES
HOLE, MISSING = CLASSES.index("hole"), CLASSES.index("missing_weld")


def crop(kind: str, rng: np.random.Generator) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """A striped band with nothing, a black disc (hole), a line along it (missing weld) or at a slant (others), and its mask."""
    rows, columns = np.indices((128, 128))
    image = 120 + 25 * np.sin(columns / rng.uniform(3, 6) + rng.uniform(0, 6)) + rng.normal(0, 4, (128, 128))
    mask = np.zeros((128, 128), bool)
    if kind == "hole":
        x, y, r = (*rng.uniform(30, 98, 2).tolist(), rng.uniform(6, 12))
        mask = np.hypot(rows - y, columns - x) < r
    elif kind == "missing_weld":
        mask = np.abs(rows - rng.uniform(56, 72)) < 4
    elif kind != "ok":
        mask = np.abs(rows - (2 + CLASSES.index(kind)) * (columns - rng.uniform(40, 88))) < 12
    image[mask] = 10
    return np.asarray(np.clip(image, 0, 255), np.uint8), mask


def crops(count: int, seed: int = 0, part_crops: int = 9) -> Crops:
    """`count` crops, their kinds in turn."""
    rng = np.random.default_rng(seed)
    drawn = [crop(KINDS[i % len(KINDS)], rng) for i in range(count)]
    maps = empty_maps(count)
    for i, (_, mask) in enumerate(drawn):
        if KINDS[i % len(KINDS)] in CHANNELS:
            maps[i, CHANNELS.index(KINDS[i % len(KINDS)])] = coarse(mask)
    names = np.array([str(i) for i in range(count)])
    parts = np.array([f"{seed}:{i // part_crops}" for i in range(count)])
    return Crops(np.stack([c for c, _ in drawn]), np.arange(count) % len(KINDS), maps, np.ones(count, bool), parts, names)


def dataset(folder: Path, count: int = 36) -> Path:
    """A folder as `weldgate-synth dataset` leaves it, without the renderer."""
    rng = np.random.default_rng(3)
    entries, coco = [], {split: _empty() for split in ("train", "val")}
    for number in range(count):
        kind, split = KINDS[number % len(KINDS)], "val" if number % 9 > 5 else "train"
        image, mask = crop(kind, rng)
        name = f"images/{split}/{kind}/{number:06d}.png"
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        content = cv2.imencode(".png", image)[1].tobytes()
        (folder / name).write_bytes(content)
        borders, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        polygons = [[int(v) for v in b.ravel()] for b in borders]
        defects = [{"kind": kind, "polygon_px": polygons}] if polygons else []
        entries.append({"file": name, "kind": kind, "seed": number // 9, "sha256": hashlib.sha256(content).hexdigest(), "defects": defects})
        _annotate(coco[split], name, kind, mask, polygons)
    (folder / "manifest.json").write_text(json.dumps({"images": entries}))
    for split, content_ in coco.items():
        (folder / f"coco_{split}.json").write_text(json.dumps(content_))
    return folder


def _empty() -> dict[str, list[dict[str, object]]]:
    categories: list[dict[str, object]] = [{"id": i, "name": name} for i, name in enumerate(CHANNELS, start=1)]
    return {"images": [], "annotations": [], "categories": categories}


def _annotate(coco: dict[str, list[dict[str, object]]], name: str, kind: str, mask: NDArray[np.bool_], polygons: list[list[int]]) -> None:
    number = len(coco["images"]) + 1
    coco["images"].append({"id": number, "file_name": name, "width": 128, "height": 128})
    if polygons:
        box = list(cv2.boundingRect(mask.astype(np.uint8)))
        coco["annotations"].append(
            {
                "id": len(coco["annotations"]) + 1,
                "image_id": number,
                "category_id": CHANNELS.index(kind) + 1,
                "bbox": box,
                "area": int(mask.sum()),
                "segmentation": polygons,
                "iscrowd": 0,
            }
        )

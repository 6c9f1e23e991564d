"""Small datasets made in code: discs and lines on stripes, so that a network can learn them in seconds."""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from models.data.crops import CHANNELS, Crops, coarse, empty_maps
from station.classify.onnx import CLASSES
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS as DEFECT_KINDS

KINDS = CLASSES
HOLE, MISSING = CLASSES.index("hole"), CLASSES.index("missing_weld")


def limits(**thresholds: float) -> Thresholds:
    """Thresholds of all kinds of defect, 0.4 unless named."""
    return Thresholds(tuple(Limit(kind, thresholds.get(kind.name, 0.4)) for kind in DEFECT_KINDS))


def crop(kind: str, rng: np.random.Generator) -> tuple[NDArray[np.uint8], NDArray[np.bool_]]:
    """A striped band and the mask of what it shows.

    Nothing, a black disc (hole), a line along the band (missing weld) or a line at a slant (others).
    """
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
    return Crops(
        images=np.stack([image for image, _ in drawn]),
        labels=np.arange(count) % len(KINDS),
        maps=maps,
        mapped=np.ones(count, bool),
        parts=parts,
        names=names,
    )


def dataset(folder: Path, count: int = 36, kinds: Sequence[str] = CLASSES) -> Path:
    """A folder as `weldgate-synth dataset` leaves it, without the renderer; it knows `kinds` only."""
    rng = np.random.default_rng(3)
    mapped = [name for name in kinds[1:] if name in CHANNELS]
    categories = [{"id": number, "name": name} for number, name in enumerate(mapped, start=1)]
    coco: dict[str, dict[str, list[dict[str, object]]]] = {
        split: {"images": [], "annotations": [], "categories": list(categories)} for split in ("train", "val")
    }
    entries = []
    for number in range(count):
        kind, split = kinds[number % len(kinds)], "val" if number % 9 > 5 else "train"
        image, mask = crop(kind, rng)
        name = f"images/{split}/{kind}/{number:06d}.png"
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        content = cv2.imencode(".png", image)[1].tobytes()
        (folder / name).write_bytes(content)
        borders, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        polygons = [[int(v) for v in b.ravel()] for b in borders] if kind in mapped else []
        entries.append(
            {
                "file": name,
                "kind": kind,
                "seed": number // 9,
                "sha256": hashlib.sha256(content).hexdigest(),
                "defects": [{"kind": kind, "polygon_px": polygons}] if polygons else [],
            }
        )
        _annotate(coco[split], name, mask, polygons, category=mapped.index(kind) + 1 if polygons else 0)
    (folder / "manifest.json").write_text(json.dumps({"images": entries}))
    for split, content_ in coco.items():
        (folder / f"coco_{split}.json").write_text(json.dumps(content_))
    return folder


def _annotate(
    coco: dict[str, list[dict[str, object]]],
    name: str,
    mask: NDArray[np.bool_],
    polygons: list[list[int]],
    *,
    category: int,
) -> None:
    number = len(coco["images"]) + 1
    coco["images"].append({"id": number, "file_name": name, "width": 128, "height": 128})
    if polygons:
        coco["annotations"].append(
            {
                "id": len(coco["annotations"]) + 1,
                "image_id": number,
                "category_id": category,
                "bbox": list(cv2.boundingRect(mask.astype(np.uint8))),
                "area": int(mask.sum()),
                "segmentation": polygons,
                "iscrowd": 0,
            }
        )

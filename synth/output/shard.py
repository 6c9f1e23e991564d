"""One shard of a dataset: rendered, cut, labelled and encoded. Runs in a worker; writes nothing."""

from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENT_PX, SEGMENTS, Ring
from station.vision.unwrap import segments, strip_to_frame, unwrap
from synth.camera.optics import Optics
from synth.camera.picture import CROP_PX, band, flat_crops, flat_window
from synth.camera.projection import ring_px
from synth.measured.spectrum import WeldModel
from synth.output.labels import Outline, mask, outlines, strip_mask
from synth.output.plan import HOLE, MISSING, RING_ERROR_PX, Crop, Shard
from synth.output.storage import encode
from synth.part.streams import Stream, stream

DETECTED = (HOLE, MISSING)
"""Classes of the detection labels, in order."""


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A shard and what is needed to make it anywhere."""

    shard: Shard
    model: WeldModel
    heights: bool


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """Files of a shard by their path in the dataset, and what the manifest and the annotations say of each image."""

    index: int
    files: dict[str, bytes]
    images: list[dict[str, Any]]


def make(job: Job) -> Made:
    """Render a shard. Same job, same bytes, on any worker with the same variant of the renderer."""
    optics = Optics()
    shots = _flat(job.shard, job.model, optics) if job.shard.is_straight else _arcs(job, optics)
    files: dict[str, bytes] = {}
    entries = []
    for crop, image, height_mm, defects in shots:
        stem = f"{job.shard.split}/{crop.kind}/{crop.number:06d}"
        png = encode(".png", image)
        files[f"images/{stem}.png"] = png
        boxes = [(DETECTED.index(o.kind), *_box(m)) for o, m in defects]
        files[f"labels/{stem}.txt"] = "".join(_yolo_line(*box) for box in boxes).encode()
        if defects:
            together = np.any([m for _, m in defects], axis=0)
            files[f"masks/{stem}.png"] = encode(".png", together.astype(np.uint8) * 255)
        if job.heights:
            files[f"heights/{stem}.tif"] = encode(".tif", (height_mm * 1000).astype(np.float32))
        entries.append(
            {
                "file": f"images/{stem}.png",
                "kind": crop.kind,
                "seed": job.shard.parts[crop.place if job.shard.is_straight else 0].seed,
                "segment": None if job.shard.is_straight else crop.place,
                "sha256": sha256(png).hexdigest(),
                "defects": [{"kind": o.kind, "box_px": _box(m), "area_px": int(m.sum()), "polygon_px": _polygons(m)} for o, m in defects],
            }
        )
    return Made(job.shard.index, files, entries)


Shot = tuple[Crop, NDArray[np.uint8], NDArray[np.float32], list[tuple[Outline, NDArray[np.bool_]]]]


def _flat(shard: Shard, model: WeldModel, optics: Optics) -> list[Shot]:
    images, heights, _ = flat_crops(shard.parts, model, optics)
    left, top, width, height = flat_window(optics)
    shots: list[Shot] = []
    for crop in shard.crops:
        found = [(o, mask(o.points - (left, top), width, height)) for o in outlines(shard.parts[crop.place], optics)]
        shots.append((crop, images[crop.place], heights[crop.place], [(o, m) for o, m in found if m.any()]))
    return shots


def _arcs(job: Job, optics: Optics) -> list[Shot]:
    """The ring's band, cut as the station cuts it, from a ring found with a small error."""
    part = job.shard.parts[0]
    image, height_mm, window = band(part, job.model, optics)
    x, y, radius = ring_px(part, optics)
    dx, dy, dr = stream(part.seed, Stream.RING_ERROR).uniform(-RING_ERROR_PX, RING_ERROR_PX, 3)
    ring = Ring(x - window[0] + float(dx), y - window[1] + float(dy), radius + float(dr), 1.0)
    crops = segments(unwrap(image, ring))
    heights = _unwrap_map(height_mm, ring) if job.heights else np.zeros((SEGMENT_PX, SEGMENTS * SEGMENT_PX), np.float32)
    masks = [(o, strip_mask(o, ring, window[:2])) for o in outlines(part, optics)]
    shots: list[Shot] = []
    for crop in job.shard.crops:
        columns = slice(crop.place * SEGMENT_PX, (crop.place + 1) * SEGMENT_PX)
        found = [(o, m[:, columns]) for o, m in masks if m[:, columns].any()]
        shots.append((crop, crops[crop.place], heights[:, columns], found))
    return shots


def _unwrap_map(values: NDArray[np.float32], ring: Ring) -> NDArray[np.float32]:
    """Strip (128, 2688) of a map of floats, by the station's formula."""
    column, row = np.meshgrid(np.arange(SEGMENTS * SEGMENT_PX), np.arange(SEGMENT_PX))
    at = strip_to_frame(ring, np.stack([column.ravel(), row.ravel()], axis=1)).astype(np.float32)
    x, y = at[:, 0].reshape(column.shape), at[:, 1].reshape(column.shape)
    return np.asarray(cv2.remap(values, x, y, cv2.INTER_LINEAR), np.float32)


def _box(m: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Left, top, width, height in px."""
    left, top, width, height = cv2.boundingRect(m.astype(np.uint8))
    return left, top, width, height


def _yolo_line(label: int, left: int, top: int, width: int, height: int) -> str:
    middle = (left + width / 2) / CROP_PX, (top + height / 2) / CROP_PX
    return f"{label} {middle[0]:.6f} {middle[1]:.6f} {width / CROP_PX:.6f} {height / CROP_PX:.6f}\n"


def _polygons(m: NDArray[np.bool_]) -> list[list[int]]:
    """Outer borders as COCO wants them: x1, y1, x2, y2 …"""
    borders, _ = cv2.findContours(m.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return [[int(v) for v in border.ravel()] for border in borders if len(border) >= 3]

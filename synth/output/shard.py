"""One shard of a dataset: rendered, cut, labelled and encoded. Runs in a worker; writes nothing."""

from dataclasses import dataclass
from hashlib import sha256
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from station.defects import KINDS
from station.domain import SEGMENT_PX, STRIP_COLUMNS, STRIP_ROWS, Ring
from station.vision.unwrap import segments, strip_to_frame, unwrap
from synth.camera.frames import CROP_PX, band, piece_crops, piece_window
from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.measured.spectrum import WeldModel
from synth.output.labels import Outline, mask, outlines, strip_mask
from synth.output.plan import RING_ERROR_PX, Crop, Shard
from synth.output.storage import encode
from synth.part.streams import Stream, stream

DETECTED = tuple(kind.name for kind in KINDS if kind.is_mapped)
"""Kinds of defect that the detection labels, masks and polygons show, in the order of their numbers."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """A shard and what is needed to make it anywhere."""

    shard: Shard
    model: WeldModel
    heights: bool


@dataclass(frozen=True, slots=True, eq=False)
class Made:
    """Files of a shard by their path in the dataset, and the entry of each image in the manifest."""

    index: int
    files: dict[str, bytes]
    images: list[dict[str, Any]]


@dataclass(frozen=True, slots=True, eq=False)
class _Shot:
    """One rendered crop (128, 128) with its heights in mm and the mask of each defect that is in view."""

    crop: Crop
    image: NDArray[np.uint8]
    height_mm: NDArray[np.float32]
    defects: list[tuple[Outline, Mask]]


def make(job: Job) -> Made:
    """Render a shard. Same job, same bytes, on any worker with the same variant of the renderer."""
    optics = Optics()
    shard = job.shard
    shots = _pieces(shard, job.model, optics) if shard.is_straight else _ring(job, optics)
    files: dict[str, bytes] = {}
    entries = []
    for shot in shots:
        stem = f"{shard.split}/{shot.crop.kind}/{shot.crop.number:06d}"
        png = encode(".png", shot.image)
        files[f"images/{stem}.png"] = png
        boxes = [(DETECTED.index(outline.kind), *_box(m)) for outline, m in shot.defects]
        files[f"labels/{stem}.txt"] = "".join(_yolo_line(box[0], box[1:]) for box in boxes).encode()
        if shot.defects:
            together = np.any([m for _, m in shot.defects], axis=0)
            files[f"masks/{stem}.png"] = encode(".png", together.astype(np.uint8) * 255)
        if job.heights:
            files[f"heights/{stem}.tif"] = encode(".tif", (shot.height_mm * 1000).astype(np.float32))
        entries.append(
            {
                "file": f"images/{stem}.png",
                "kind": shot.crop.kind,
                "seed": shard.parts[shot.crop.place if shard.is_straight else 0].seed,
                "segment": None if shard.is_straight else shot.crop.place,
                "sha256": sha256(png).hexdigest(),
                "defects": [_entry(outline.kind, m) for outline, m in shot.defects],
            }
        )
    return Made(shard.index, files, entries)


def _pieces(shard: Shard, model: WeldModel, optics: Optics) -> list[_Shot]:
    images, heights, _ = piece_crops(shard.parts, model, optics)
    left, top, width, height = piece_window(optics)
    shots = []
    for crop in shard.crops:
        seen = [
            (o, mask(o.points - (left, top), width, height))
            for o in outlines(shard.parts[crop.place], optics)
        ]
        shots.append(_Shot(crop, images[crop.place], heights[crop.place], _in_view(seen)))
    return shots


def _ring(job: Job, optics: Optics) -> list[_Shot]:
    """Render the ring's band and cut it as the station does, from a ring found with a small error."""
    part = job.shard.parts[0]
    image, height_mm, window = band(part, job.model, optics)
    x, y, radius = ring_px(part, optics)
    error = stream(part.seed, Stream.RING_ERROR).uniform(-RING_ERROR_PX, RING_ERROR_PX, 3)
    ring = Ring(
        x - window[0] + float(error[0]), y - window[1] + float(error[1]), radius + float(error[2]), 1.0
    )
    images = segments(unwrap(image, ring, um_per_px=optics.um_per_px))
    heights = (
        _unwrap_map(height_mm, ring, optics)
        if job.heights
        else np.zeros((STRIP_ROWS, STRIP_COLUMNS), np.float32)
    )
    masks = [
        (outline, strip_mask(outline, ring, window[:2], um_per_px=optics.um_per_px))
        for outline in outlines(part, optics)
    ]
    shots = []
    for crop in job.shard.crops:
        columns = slice(crop.place * SEGMENT_PX, (crop.place + 1) * SEGMENT_PX)
        seen = [(outline, m[:, columns]) for outline, m in masks]
        shots.append(_Shot(crop, images[crop.place], heights[:, columns], _in_view(seen)))
    return shots


def _in_view(masks: list[tuple[Outline, Mask]]) -> list[tuple[Outline, Mask]]:
    """Return the masks that detection labels show."""
    return [(outline, m) for outline, m in masks if outline.kind in DETECTED and m.any()]


def _unwrap_map(values: NDArray[np.float32], ring: Ring, optics: Optics) -> NDArray[np.float32]:
    """Return the strip (128, 2688) of a map of floats, by the station's formula."""
    column, row = np.meshgrid(np.arange(STRIP_COLUMNS), np.arange(STRIP_ROWS))
    points = np.stack([column.ravel(), row.ravel()], axis=1).astype(np.float64)
    at = strip_to_frame(ring, points, um_per_px=optics.um_per_px).astype(np.float32)
    x, y = at[:, 0].reshape(column.shape), at[:, 1].reshape(column.shape)
    return np.asarray(cv2.remap(values, x, y, cv2.INTER_LINEAR), np.float32)


def _entry(kind: str, m: Mask) -> dict[str, Any]:
    """Return the manifest entry of a defect: `rle` is its exact mask, `polygon_px` its outer borders."""
    return {
        "kind": kind,
        "box_px": _box(m),
        "area_px": int(m.sum()),
        "polygon_px": _polygons(m),
        "rle": run_lengths(m),
    }


def run_lengths(m: Mask) -> dict[str, list[int]]:
    """Return a mask as COCO's uncompressed run lengths: column by column, the first run outside the mask."""
    flat = np.concatenate([[False], m.ravel(order="F"), [not m[-1, -1]]])
    ends = np.flatnonzero(flat[1:] != flat[:-1])
    return {"size": list(m.shape), "counts": np.diff(ends, prepend=0).tolist()}


def _box(m: Mask) -> tuple[int, int, int, int]:
    """Return left, top, width, height in px."""
    left, top, width, height = cv2.boundingRect(m.astype(np.uint8))
    return left, top, width, height


def _yolo_line(number: int, box_px: tuple[int, int, int, int]) -> str:
    left, top, width, height = (value / CROP_PX for value in box_px)
    return f"{number} {left + width / 2:.6f} {top + height / 2:.6f} {width:.6f} {height:.6f}\n"


def _polygons(m: Mask) -> list[list[int]]:
    """Return the outer borders as COCO states them: x1, y1, x2, y2 and so on."""
    borders, _ = cv2.findContours(m.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    return [[int(v) for v in border.ravel()] for border in borders if len(border) >= 3]

"""Lots of the second renderer: pictures, masks of what each pixel shows, and labels.

A lot is `frames/part_NNNNNNNN.png`, `masks/part_NNNNNNNN.png` (values of `Place`) and `labels.json`. Each
part's label is first written next to its image, so that a killed run continues where it stopped.
"""

import json
import multiprocessing
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path
from typing import Any

import cv2

from synth.heightfield.part import Order, Pictured, picture
from synth.output.storage import claim, write_image, write_text

CONVENTION = (
    "angle 0 = +x (right), clockwise as seen in the image, [start, end], end may exceed 360; "
    "pixels (x, y) of the given image; mm on the object; center and radius: circle of the bead's centre "
    "line, null without a weld"
)


def write_pictures(
    out: Path, order: Order, *, seed: int, count: int, workers: int, done: Callable[[], None]
) -> None:
    """Draw `count` parts into `out`. `done` is called after each part.

    Raises SynthError if `out` holds a lot of another seed or order.
    """
    out.mkdir(parents=True, exist_ok=True)
    manifest = {"convention": CONVENTION, "seed": seed, "um_per_px": order.um_per_px, "order": asdict(order)}
    claim(out / "manifest.json", manifest)
    seeds = [seed * 1_000_000 + index for index in range(count)]
    missing = [own for own in seeds if not _side(out, own).exists()]
    for _ in range(count - len(missing)):
        done()
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context, initializer=_one_thread) as pool:
        for _ in pool.map(_write, [(out, order, own) for own in missing], chunksize=4):
            done()
    labels = [json.loads(_side(out, own).read_text()) for own in seeds]
    write_text(out / "labels.json", json.dumps({**manifest, "frames": labels}, indent=1))


def _one_thread() -> None:
    cv2.setNumThreads(1)


def _side(out: Path, seed: int) -> Path:
    return out / "frames" / f"part_{seed:08d}.json"


def _write(job: tuple[Path, Order, int]) -> None:
    out, order, seed = job
    name = f"part_{seed:08d}.png"
    pictured = picture(seed, order)
    write_image(out / "frames" / name, pictured.image)
    write_image(out / "masks" / name, pictured.place)
    write_text(_side(out, seed), json.dumps(_label(name, pictured, order.um_per_px)))


def _label(name: str, pictured: Pictured, um_per_px: float) -> dict[str, Any]:
    height, width = pictured.image.shape
    course, per_mm = pictured.course, 1000 / um_per_px
    label: dict[str, Any] = {
        "frame": name,
        "size": [width, height],
        "sheet": pictured.sheet,
        "disc": pictured.disc,
        "weld": pictured.weld,
        "center": None,
        "radius": None,
        "defects": [],
    }
    if course is not None:
        label["center"] = [
            round(course.x_mm * per_mm + (width - 1) / 2, 3),
            round(course.y_mm * per_mm + (height - 1) / 2, 3),
        ]
        label["radius"] = round(course.radius_mm * per_mm, 3)
        label["bead_halfwidth_mm"] = round(course.half_width_mm, 3)
        label["defects"] = [
            {"kind": "missing_weld", "family": "bare_joint", "angle_deg": [round(start, 3), round(end, 3)]}
            for start, end in course.missing_deg
        ] + [
            {
                "kind": "hole",
                "family": hole.family,
                "angle_deg": [round(hole.start_deg, 3), round(hole.end_deg, 3)],
                "length_mm": round(hole.length_mm, 3),
                "width_mm": round(hole.width_mm, 3),
            }
            for hole in pictured.holes
        ]
    label["verdict"] = "NOK" if label["defects"] else "OK"
    return label

"""Folders of rendered parts: images, exact labels and what is needed to make them again.

A lot is `frames/part_NNNNNN.png` plus `labels.json`; each part's label is first written beside its image, so that a
killed run goes on where it stopped, without a lost or doubled part.
"""

import json
import os
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path

import cv2
import numpy as np

from synth.errors import SynthError
from synth.labels import label, ring_px
from synth.optics import Optics
from synth.part import Part, Truth, draw_part
from synth.recipe import Recipe

RING_WINDOW_PX = 1120
"""Side of the window that holds the ring with its strip."""

CONVENTION = (
    "angle 0 = +x (right), clockwise as seen in the image, [start, end], end may exceed 360; "
    "pixels (x, y) of the given image; mm on the object"
)


def plan(seed: int, count: int, shares: dict[Truth, float]) -> Iterator[tuple[int, Truth]]:
    """Seeds and truths of a lot: the shares hold in any long stretch, in an order drawn from `seed`."""
    rng = np.random.default_rng([seed, 0])
    truths = list(shares)
    weights = np.array([shares[t] for t in truths])
    for index in range(count):
        yield seed * 1_000_000 + index, truths[int(rng.choice(len(truths), p=weights / weights.sum()))]


def ring_window(part: Part, optics: Optics) -> tuple[int, int, int, int]:
    """Window (x, y, width, height) round the ring, inside the frame."""
    x, y, _ = ring_px(part, optics)
    half = RING_WINDOW_PX // 2
    left = int(np.clip(round(x) - half, 0, optics.width_px - RING_WINDOW_PX))
    top = int(np.clip(round(y) - half, 0, optics.height_px - RING_WINDOW_PX))
    return left, top, RING_WINDOW_PX, RING_WINDOW_PX


def write_lot(out: Path, seed: int, count: int, shares: dict[Truth, float], recipe: Recipe, whole: bool, done: Callable[[], None]) -> None:
    """Render `count` parts into `out`; whole frames or windows round the ring. `done` is called after each part.

    Raises SynthError if `out` holds a lot of another seed or recipe.
    """
    from synth.render import render
    from synth.sensor import expose

    optics = Optics()
    frames = out / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    manifest = {"convention": CONVENTION, "seed": seed, "whole": whole, "recipe": asdict(recipe)}
    _claim(out / "manifest.json", manifest)
    labels = []
    for part_seed, truth in plan(seed, count, shares):
        name = f"part_{part_seed:08d}.png"
        side = frames / f"part_{part_seed:08d}.json"
        if not side.exists():
            part = draw_part(part_seed, truth, recipe)
            window = (0, 0, optics.width_px, optics.height_px) if whole else ring_window(part, optics)
            image = expose(render(part, optics, window), part, optics, window[:2])
            _write_image(frames / name, image)
            _write_text(side, json.dumps(label(part, optics, name, window[:2], window[2:])))
        labels.append(json.loads(side.read_text()))
        done()
    _write_text(out / "labels.json", json.dumps({**manifest, "frames": labels}, indent=1))


def _claim(path: Path, manifest: dict[str, object]) -> None:
    wanted = json.loads(json.dumps(manifest))
    if path.exists():
        if json.loads(path.read_text()) != wanted:
            raise SynthError(f"{path.parent}: holds a lot of another seed or recipe; name an empty folder with --out")
    else:
        _write_text(path, json.dumps(wanted, indent=1))


def _write_image(path: Path, image: np.ndarray) -> None:
    part = path.with_suffix(".part.png")
    if not cv2.imwrite(str(part), image, [cv2.IMWRITE_PNG_COMPRESSION, 3]):
        raise SynthError(f"{path}: could not be written; is the disk full?")
    os.replace(part, path)


def _write_text(path: Path, text: str) -> None:
    part = path.with_suffix(".tmp")
    part.write_text(text)
    os.replace(part, path)

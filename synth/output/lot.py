"""Folders of rendered parts: images, exact labels and what is needed to make them again.

A lot is `frames/part_NNNNNN.png` plus `labels.json`; each part's label is first written beside its image, so that a
killed run goes on where it stopped, without a lost or doubled part.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict
from pathlib import Path

import numpy as np

from station.domain import STRIP_COLUMNS, STRIP_ROWS, Ring
from station.vision.unwrap import unwrap
from synth.camera.optics import Optics
from synth.camera.picture import Image, Window, picture, ring_window
from synth.camera.projection import ring_px
from synth.measured.spectrum import WeldModel
from synth.output.labels import label, mask, outlines, strip_mask
from synth.output.storage import claim, write_image, write_text
from synth.part.part import Part, Truth, draw_part
from synth.part.recipe import Recipe
from synth.part.streams import Stream, stream
from synth.part.switches import Switch

CONVENTION = (
    "angle 0 = +x (right), clockwise as seen in the image, [start, end], end may exceed 360; "
    "pixels (x, y) of the given image; mm on the object"
)


def plan(seed: int, count: int, shares: dict[Truth, float]) -> Iterator[tuple[int, Truth]]:
    """Seeds and truths of a lot: the shares hold in any long stretch, in an order drawn from `seed`."""
    rng = stream(seed, Stream.LOT)
    truths = list(shares)
    weights = np.array([shares[t] for t in truths])
    for index in range(count):
        yield seed * 1_000_000 + index, truths[int(rng.choice(len(truths), p=weights / weights.sum()))]


def write_lot(
    out: Path,
    seed: int,
    count: int,
    shares: dict[Truth, float],
    recipe: Recipe,
    switches: frozenset[Switch],
    model: WeldModel,
    whole: bool,
    strips: bool,
    done: Callable[[], None],
) -> None:
    """Render `count` parts into `out`; whole frames or windows round the ring; with `strips`, the unwrapped
    strips and the masks of frames and strips as well. `done` is called after each part.

    Raises SynthError if `out` holds a lot of another seed or recipe.
    """
    optics = Optics()
    frames = out / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    manifest = {
        "convention": CONVENTION,
        "seed": seed,
        "whole": whole,
        "recipe": asdict(recipe),
        "switches": sorted(switches),
        "measurement_sha256": model.sha256,
    }
    claim(out / "manifest.json", manifest)
    labels = []
    for part_seed, truth in plan(seed, count, shares):
        name = f"part_{part_seed:08d}.png"
        side = frames / f"part_{part_seed:08d}.json"
        if not side.exists():
            part = draw_part(part_seed, truth, recipe, switches)
            window = (0, 0, optics.width_px, optics.height_px) if whole else ring_window(part, optics)
            image = picture(part, model, optics, window)
            if strips:
                _write_strips(out, name, part, optics, image, window)
            write_image(frames / name, image)
            write_text(side, json.dumps(label(part, optics, name, window[:2], window[2:])))
        labels.append(json.loads(side.read_text()))
        done()
    write_text(out / "labels.json", json.dumps({**manifest, "frames": labels}, indent=1))


def _write_strips(out: Path, name: str, part: Part, optics: Optics, image: Image, window: Window) -> None:
    """strips/ as the station unwraps them from the true ring; masks/ and strip_masks/: 255 where a defect is."""
    left, top, width, height = window
    x, y, radius = ring_px(part, optics)
    ring = Ring(x - left, y - top, radius, 1.0)
    in_frame, in_strip = np.zeros((height, width), bool), np.zeros((STRIP_ROWS, STRIP_COLUMNS), bool)
    for opening in outlines(part, optics):
        in_frame |= mask(opening.points - (left, top), width, height)
        in_strip |= strip_mask(opening, ring, (left, top))
    write_image(out / "masks" / name, in_frame.astype(np.uint8) * 255)
    write_image(out / "strips" / name, unwrap(image, ring))
    write_image(out / "strip_masks" / name, in_strip.astype(np.uint8) * 255)

"""Lots: folders of rendered parts with exact labels and what is needed to make them again.

A lot is `frames/part_NNNNNN.png` plus `labels.json`. Each part's label is first written next to its image, so
that a killed run continues where it stopped, without a lost or doubled part.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from station.domain import STRIP_COLUMNS, STRIP_ROWS, Ring
from station.vision.unwrap import unwrap
from synth.camera.frames import Image, Window, frame_window, ring_window
from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.labels import label, mask, outlines, strip_mask
from synth.output.storage import claim, write_image, write_text
from synth.part.part import Part, draw_part
from synth.part.recipe import Recipe
from synth.part.streams import Stream, stream
from synth.part.switches import Switch

CONVENTION = (
    "angle 0 = +x (right), clockwise as seen in the image, [start, end], end may exceed 360; "
    "pixels (x, y) of the given image; mm on the object"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class LotOrder:
    """What a lot is to hold."""

    seed: int
    count: int
    recipe: Recipe
    switches: frozenset[Switch]
    is_whole: bool = True
    """True for whole frames, False for windows round the ring."""
    has_strips: bool = False
    """True if the unwrapped strips and the masks of frames and strips are written as well."""


def plan(seed: int, count: int, recipe: Recipe) -> Iterator[tuple[int, str | None]]:
    """Yield the seed and the kind of defect of each part: the recipe's weights hold in any long stretch.

    Raises SynthError if all weights are 0.
    """
    rng = stream(seed, Stream.LOT)
    kinds = [None, *recipe.defects]
    weights = np.array([recipe.ok_weight, *(ranges.weight for ranges in recipe.defects.values())])
    if weights.sum() <= 0:
        raise SynthError("ok_weight and the weights of all kinds of defect are 0; raise one of them")
    for index in range(count):
        yield seed * 1_000_000 + index, kinds[int(rng.choice(len(kinds), p=weights / weights.sum()))]


def write_lot(out: Path, order: LotOrder, model: WeldModel, done: Callable[[], None]) -> None:
    """Render a lot into `out`. `done` is called after each part.

    Raises SynthError if `out` holds a lot of another seed or recipe.
    """
    optics = Optics()
    frames = out / "frames"
    frames.mkdir(parents=True, exist_ok=True)
    manifest = {
        "convention": CONVENTION,
        "seed": order.seed,
        "whole": order.is_whole,
        "recipe": order.recipe.tables(),
        "switches": sorted(order.switches),
        "measurement_sha256": model.sha256,
    }
    claim(out / "manifest.json", manifest)
    labels = []
    for part_seed, kind in plan(order.seed, order.count, order.recipe):
        name = f"part_{part_seed:08d}.png"
        side = frames / f"part_{part_seed:08d}.json"
        if not side.exists():
            part = draw_part(part_seed, order.recipe, kind=kind, switches=order.switches)
            window = (
                (0, 0, optics.width_px, optics.height_px) if order.is_whole else ring_window(part, optics)
            )
            image = frame_window(part, model, optics, window)
            if order.has_strips:
                _write_strips(out, name, part=part, optics=optics, image=image, window=window)
            write_image(frames / name, image)
            written = label(part, optics, name=name, origin_px=window[:2], size_px=window[2:])
            write_text(side, json.dumps(written))
        labels.append(json.loads(side.read_text()))
        done()
    write_text(out / "labels.json", json.dumps({**manifest, "frames": labels}, indent=1))


def _write_strips(out: Path, name: str, *, part: Part, optics: Optics, image: Image, window: Window) -> None:
    """Write the strip as the station unwraps it from the true ring, and masks, 255 where a defect is."""
    left, top, width, height = window
    x, y, radius = ring_px(part, optics)
    ring = Ring(x - left, y - top, radius, 1.0)
    in_frame, in_strip = np.zeros((height, width), bool), np.zeros((STRIP_ROWS, STRIP_COLUMNS), bool)
    for outline in outlines(part, optics):
        in_frame |= mask(outline.points - (left, top), width, height)
        in_strip |= strip_mask(outline, ring, (left, top), um_per_px=optics.um_per_px)
    write_image(out / "masks" / name, in_frame.astype(np.uint8) * 255)
    write_image(out / "strips" / name, unwrap(image, ring, um_per_px=optics.um_per_px))
    write_image(out / "strip_masks" / name, in_strip.astype(np.uint8) * 255)

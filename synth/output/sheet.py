"""Contact sheets: many crops on one image for the eye (paper, Fig. 8)."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from station.classify.crop_label import OK
from synth.camera.frames import piece_crops
from synth.camera.optics import Optics
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.plan import CROP_KINDS, plan_pieces
from synth.output.storage import write_image
from synth.part.part import GRAVITY, Part
from synth.part.recipe import Recipe
from synth.part.switches import ALL, Switch

Image = NDArray[np.uint8]

ROWS_PER_KIND, COLUMNS = 4, 12
GAP_PX, HEAD_PX = 6, 26
PAPER_GREY = 245
QUIET_NOISE_DN = 0.5
"""Read noise of the crops that compare switches."""


def dataset_sheet(folder: Path, out: Path) -> None:
    """Write a sheet of a dataset: crops of each kind, evenly picked. Raises SynthError if there is none."""
    try:
        entries = json.loads((folder / "manifest.json").read_text())["images"]
    except (OSError, ValueError, KeyError):
        reason = "no finished dataset (manifest.json with its images is missing); make it first"
        raise SynthError(f"{folder}: {reason}") from None
    blocks = []
    for kind in CROP_KINDS:
        of_kind: list[dict[str, Any]] = [entry for entry in entries if entry["kind"] == kind]
        if of_kind:
            picked = np.unique(np.linspace(0, len(of_kind) - 1, ROWS_PER_KIND * COLUMNS).astype(int))
            crops = [_read(folder / of_kind[i]["file"]) for i in picked]
            blocks.append(_block(f"{kind}: {len(of_kind)} crops", crops))
    write_image(out, np.concatenate(blocks))


def switch_sheet(seed: int, recipe: Recipe, model: WeldModel, out: Path) -> None:
    """Write a sheet of the same crops with all switches on, then with one off at a time."""
    optics = Optics()
    each = COLUMNS // 2 // len(GRAVITY)
    ordered = {OK: COLUMNS - each * len(GRAVITY), **dict.fromkeys(GRAVITY, each)}
    blocks = []
    for name, switches in [("all on", ALL), *((f"without {switch}", ALL - {switch}) for switch in Switch)]:
        parts = [part for shard in plan_pieces(seed, ordered, recipe, switches) for part in shard.parts]
        parts.sort(key=lambda part: -1 if part.kind is None else GRAVITY[part.kind])
        crops, _, _ = piece_crops([_quiet(part) for part in parts], model, optics)
        blocks.append(_block(name, crops))
    write_image(out, np.concatenate(blocks))


def _quiet(part: Part) -> Part:
    return replace(part, sensor=replace(part.sensor, read_noise_dn=QUIET_NOISE_DN))


def _read(path: Path) -> Image:
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise SynthError(f"{path}: not a readable image")
    return np.asarray(image, np.uint8)


def _block(title: str, crops: list[Image]) -> Image:
    """Return crops in rows under a title."""
    side = crops[0].shape[0]
    step, rows = side + GAP_PX, -(-len(crops) // COLUMNS)
    sheet = np.full((HEAD_PX + rows * step, COLUMNS * step + GAP_PX), PAPER_GREY, np.uint8)
    cv2.putText(sheet, title, (GAP_PX, HEAD_PX - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.55, 20, 1, cv2.LINE_AA)
    for i, crop in enumerate(crops):
        top, left = HEAD_PX + i // COLUMNS * step, GAP_PX + i % COLUMNS * step
        sheet[top : top + side, left : left + side] = crop
    return sheet

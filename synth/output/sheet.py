"""Contact sheets: many crops on one picture for the eye (paper, Fig. 8)."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.camera.optics import Optics
from synth.camera.picture import flat_crops
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.plan import HOLE, KINDS, MISSING, OK, plan_flat
from synth.output.storage import write_image
from synth.part.recipe import Recipe
from synth.part.switches import ALL, Switch

Image = NDArray[np.uint8]

ROWS_PER_KIND, COLUMNS = 4, 12
GAP, HEAD = 6, 26
PAPER_GREY = 245


def dataset_sheet(folder: Path, out: Path) -> None:
    """Sheet of a dataset: crops of each kind, evenly picked, defects' boxes not drawn. Raises SynthError if there is none."""
    try:
        entries = json.loads((folder / "manifest.json").read_text())["images"]
    except (OSError, ValueError, KeyError):
        raise SynthError(f"{folder}: no finished dataset (manifest.json with its images is missing); make it first") from None
    blocks = []
    for kind in KINDS:
        of_kind: list[dict[str, Any]] = [e for e in entries if e["kind"] == kind]
        picked = [of_kind[i] for i in np.unique(np.linspace(0, len(of_kind) - 1, ROWS_PER_KIND * COLUMNS).astype(int))] if of_kind else []
        crops = [_read(folder / e["file"]) for e in picked]
        if crops:
            blocks.append(_block(f"{kind}: {len(of_kind)} crops", crops))
    write_image(out, np.concatenate(blocks))


def switch_sheet(seed: int, recipe: Recipe, model: WeldModel, out: Path) -> None:
    """The same crops with all switches on, then with one off at a time."""
    optics = Optics()
    wanted = {OK: COLUMNS // 2, HOLE: COLUMNS // 4, MISSING: COLUMNS // 4}
    blocks = []
    for name, switches in [("all on", ALL), *((f"without {switch}", ALL - {switch}) for switch in Switch)]:
        parts = [p for shard in plan_flat(seed, wanted, recipe, switches) for p in shard.parts]
        parts.sort(key=lambda p: p.truth)
        crops, _, _ = flat_crops([replace(p, read_noise_dn=0.5) for p in parts], model, optics)
        blocks.append(_block(name, crops))
    write_image(out, np.concatenate(blocks))


def _read(path: Path) -> Image:
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise SynthError(f"{path}: not a readable image")
    return np.asarray(image, np.uint8)


def _block(title: str, crops: list[Image]) -> Image:
    side = crops[0].shape[0]
    rows = -(-len(crops) // COLUMNS)
    sheet = np.full((HEAD + rows * (side + GAP), COLUMNS * (side + GAP) + GAP), PAPER_GREY, np.uint8)
    cv2.putText(sheet, title, (GAP, HEAD - 8), cv2.FONT_HERSHEY_SIMPLEX, 0.55, 20, 1, cv2.LINE_AA)
    for i, crop in enumerate(crops):
        top, left = HEAD + i // COLUMNS * (side + GAP), GAP + i % COLUMNS * (side + GAP)
        sheet[top : top + side, left : left + side] = crop
    return sheet

"""Roughness of weld and partner from images: the renders whose histograms are nearest (paper, section 4.1)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.camera.optics import Optics
from synth.camera.picture import CROP_PX, flat_crops
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.plan import OK, plan_flat
from synth.part.recipe import Recipe
from synth.part.switches import Switch

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

ALPHAS = np.round(np.arange(0.02, 0.501, 0.02), 2)
RENDERS = 5
BINS = 64


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """Chi-square distance over `ALPHAS` (25,) of the weld's and of the partners' histograms, mean over the renders.

    Of all 625 pairs of alphas the nearest is the pair of both minima: light that goes from weld to partner is not rendered, so each
    region's histogram depends on its own alpha alone, and a pair's distance is the sum.
    """

    weld: Array
    partner: Array

    @property
    def alpha_weld(self) -> float:
        """Nearest roughness of the weld."""
        return float(ALPHAS[self.weld.argmin()])

    @property
    def alpha_partner(self) -> float:
        """Nearest roughness of the partners."""
        return float(ALPHAS[self.partner.argmin()])

    @property
    def pairs(self) -> Array:
        """Distance (25, 25) of each pair (weld, partner)."""
        return self.weld[:, None] + self.partner[None, :]


def calibrate(
    images: Sequence[Image],
    recipe: Recipe,
    switches: frozenset[Switch],
    model: WeldModel,
    seed: int,
    renders: int = RENDERS,
    done: Callable[[], None] = lambda: None,
) -> Calibration:
    """Compare crops (K, 128, 128) uint8 of OK welds with renders over the grid of alphas.

    The recipe's exposure must be the images': histograms are of grey levels. Raises SynthError if there are no images.
    """
    if not images:
        raise SynthError("no images to calibrate against")
    weld_rows, partner_rows = regions(recipe)
    given = [_histogram(images, rows) for rows in (weld_rows, partner_rows)]
    distance = np.zeros((2, ALPHAS.size))
    parts = [p for shard in plan_flat(seed, {OK: renders}, recipe, switches) for p in shard.parts]
    for i, alpha in enumerate(ALPHAS):
        rough = [replace(p, alpha_weld=float(alpha), alpha_partner=float(alpha)) for p in parts]
        crops, _, _ = flat_crops(rough, model, Optics())
        for j, rows in enumerate((weld_rows, partner_rows)):
            distance[j, i] = np.mean([chi_square(_histogram([crop], rows), given[j]) for crop in crops])
        done()
    return Calibration(distance[0], distance[1])


def regions(recipe: Recipe) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Rows (128,) of a crop that show only the weld, and only the partners, whatever part the recipe draws."""
    away_mm = np.abs(np.arange(CROP_PX) - (CROP_PX - 1) / 2) * Optics().pixel_mm
    low, high = recipe.half_width_mm
    offset = max(abs(v) for v in recipe.bead_offset_mm)
    border = offset + 3 * recipe.wobble_mm[1]
    weld, partner = away_mm < low - border - 0.05, away_mm > high + border + 0.05
    if not weld.any() or not partner.any():
        raise SynthError("the recipe's widths of the bead leave no rows that show only the weld or only the partners")
    return weld, partner


def chi_square(a: Array, b: Array) -> float:
    """Chi-square distance of two normalised histograms: sum of (a - b)^2 / (a + b) over 2, 0 to 1."""
    both = a + b
    return float(0.5 * ((a - b) ** 2 / np.where(both > 0, both, 1.0)).sum())


def read_crops(paths: Sequence[Path]) -> list[Image]:
    """Crops or strips (128, n * 128) of files or folders. Raises SynthError listing what is unfit."""
    files = [f for path in paths for f in (sorted(path.glob("*.png")) if path.is_dir() else [path])]
    crops, unfit = [], []
    for file in files:
        image = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        if image is None or image.shape[0] != CROP_PX or image.shape[1] % CROP_PX:
            unfit.append(f"{file}: {'not a readable image' if image is None else f'{image.shape[1]} x {image.shape[0]} px'}")
            continue
        crops += list(np.asarray(image, np.uint8).reshape(CROP_PX, -1, CROP_PX).transpose(1, 0, 2))
    if unfit:
        raise SynthError(f"{len(unfit)} of {len(files)} files are no crops or strips of 128 px height: {'; '.join(unfit[:5])}")
    if not crops:
        raise SynthError(f"no png files in {', '.join(map(str, paths))}")
    return crops


def _histogram(images: Sequence[Image], rows: NDArray[np.bool_]) -> Array:
    counts, _ = np.histogram(np.concatenate([image[rows].ravel() for image in images]), BINS, (0, 256))
    return np.asarray(counts / counts.sum())

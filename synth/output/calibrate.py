"""Roughness of weld and partners from images: of the renders with the nearest histograms (paper, 4.1)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from station.classify.crop_label import OK
from synth.camera.frames import CROP_PX, piece_crops
from synth.camera.optics import Optics
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.plan import plan_pieces
from synth.part.part import Part
from synth.part.recipe import Recipe
from synth.part.switches import Switch

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

ALPHAS = np.round(np.arange(0.02, 0.501, 0.02), 2)
"""Roughnesses that are tried."""
BINS = 64
"""Bins of a histogram of grey levels."""


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """Chi-square distances over `ALPHAS` (25,) of the weld's and the partners' histograms, mean over renders.

    Of all 625 pairs of alphas the nearest is the pair of both minima: light that passes from weld to partner
    is not rendered, so each region's histogram depends on its own alpha alone, and a pair's distance is the
    sum.
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
    model: WeldModel,
    *,
    switches: frozenset[Switch],
    seed: int,
    renders: int,
    done: Callable[[], None] = lambda: None,
) -> Calibration:
    """Compare crops (K, 128, 128) uint8 of OK welds with renders over the grid of alphas.

    The recipe's exposure must be that of the images: histograms are of grey levels. Raises SynthError without
    images.
    """
    if not images:
        raise SynthError("no images to calibrate against")
    weld_rows, partner_rows = regions(recipe)
    given = [_histogram(images, rows) for rows in (weld_rows, partner_rows)]
    distance = np.zeros((2, ALPHAS.size))
    parts = [part for shard in plan_pieces(seed, {OK: renders}, recipe, switches) for part in shard.parts]
    for i, alpha in enumerate(ALPHAS):
        rough = [_with_roughness(part, float(alpha)) for part in parts]
        crops, _, _ = piece_crops(rough, model, Optics())
        for j, rows in enumerate((weld_rows, partner_rows)):
            distance[j, i] = np.mean([chi_square(_histogram([crop], rows), given[j]) for crop in crops])
        done()
    return Calibration(distance[0], distance[1])


def regions(recipe: Recipe) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the rows (128,) of a crop that show only weld, and only partners, for any part of the recipe."""
    away_mm = np.abs(np.arange(CROP_PX) - (CROP_PX - 1) / 2) * Optics().pixel_mm
    low, high = recipe.bead.half_width_mm
    offset = max(abs(v) for v in recipe.bead.offset_mm)
    border = offset + 3 * recipe.bead.wobble_mm[1]
    weld, partner = away_mm < low - border - 0.05, away_mm > high + border + 0.05
    if not weld.any() or not partner.any():
        raise SynthError(
            "the recipe's widths of the bead leave no rows that show only the weld or only the partners"
        )
    return weld, partner


def chi_square(a: Array, b: Array) -> float:
    """Return the chi-square distance of two normalised histograms, sum of (a - b)^2 / (a + b) / 2: 0 to 1."""
    both = a + b
    return float(0.5 * ((a - b) ** 2 / np.where(both > 0, both, 1.0)).sum())


def read_crops(paths: Sequence[Path]) -> list[Image]:
    """Read crops or strips (128, n * 128) of files or folders. Raises SynthError listing what is unfit."""
    files = [f for path in paths for f in (sorted(path.glob("*.png")) if path.is_dir() else [path])]
    crops, unfit = [], []
    for file in files:
        image = cv2.imread(str(file), cv2.IMREAD_GRAYSCALE)
        if image is None:
            unfit.append(f"{file}: not a readable image")
        elif image.shape[0] != CROP_PX or image.shape[1] % CROP_PX:
            unfit.append(f"{file}: {image.shape[1]} x {image.shape[0]} px")
        else:
            crops += list(np.asarray(image, np.uint8).reshape(CROP_PX, -1, CROP_PX).transpose(1, 0, 2))
    if unfit:
        counted = f"{len(unfit)} of {len(files)} files are not crops or strips of {CROP_PX} px height"
        raise SynthError(f"{counted}: {'; '.join(unfit[:5])}")
    if not crops:
        raise SynthError(f"no png files in {', '.join(map(str, paths))}")
    return crops


def _with_roughness(part: Part, alpha: float) -> Part:
    return replace(part, surface=replace(part.surface, alpha_weld=alpha, alpha_partner=alpha))


def _histogram(images: Sequence[Image], rows: NDArray[np.bool_]) -> Array:
    counts, _ = np.histogram(np.concatenate([image[rows].ravel() for image in images]), BINS, (0, 256))
    return np.asarray(counts / counts.sum())

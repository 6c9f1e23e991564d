"""Alphas that are known are found again; and images that are no crops are refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from synth.camera.frames import piece_crops
from synth.camera.optics import Optics
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.calibrate import ALPHAS, calibrate, chi_square, read_crops, regions
from synth.output.plan import plan_pieces
from synth.output.storage import write_image
from synth.part.switches import ALL
from synth.recipes.named import LINE, PAPER


@pytest.mark.render
def test_hidden_alphas_are_found_again(model: WeldModel) -> None:
    hidden = replace(
        PAPER, surface=replace(PAPER.surface, alpha_weld=(0.27, 0.27), alpha_partner=(0.13, 0.13))
    )
    parts = [p for shard in plan_pieces(91, {"ok": 24}, hidden, ALL) for p in shard.parts]
    images, _, _ = piece_crops(parts, model, Optics())
    found = calibrate(images, PAPER, model, switches=ALL, seed=4, renders=12)
    assert found.alpha_weld == pytest.approx(0.27, abs=0.031)
    assert found.alpha_partner == pytest.approx(0.13, abs=0.031)
    assert np.unravel_index(found.pairs.argmin(), found.pairs.shape) == (
        list(ALPHAS).index(found.alpha_weld),
        list(ALPHAS).index(found.alpha_partner),
    )


def test_the_grid_is_the_papers() -> None:
    assert ALPHAS[0] == 0.02
    assert ALPHAS[-1] == 0.5
    assert len(ALPHAS) == 25


def test_chi_square_is_0_for_the_same_and_1_for_disjoint() -> None:
    a, b = np.array([0.5, 0.5, 0.0]), np.array([0.0, 0.0, 1.0])
    assert chi_square(a, a) == 0
    assert chi_square(a, b) == pytest.approx(1.0)


def test_regions_do_not_meet() -> None:
    weld, partner = regions(PAPER)
    assert not (weld & partner).any()
    assert weld.sum() > 20
    with pytest.raises(SynthError, match="leave no rows"):
        regions(replace(LINE, bead=replace(LINE.bead, half_width_mm=(0.2, 0.7), wobble_mm=(0.0, 0.2))))


def test_what_is_no_crop_is_listed(tmp_path: Path) -> None:
    write_image(tmp_path / "a.png", np.zeros((128, 256), np.uint8))
    assert len(read_crops([tmp_path])) == 2
    write_image(tmp_path / "b.png", np.zeros((100, 100), np.uint8))
    (tmp_path / "c.png").write_text("no image")
    with pytest.raises(SynthError, match=r"2 of 3 files .*b\.png: 100 x 100 px; .*c\.png: not a readable"):
        read_crops([tmp_path])
    (tmp_path / "nothing").mkdir()
    with pytest.raises(SynthError, match="no png files"):
        read_crops([tmp_path / "nothing"])

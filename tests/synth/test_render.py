"""Renders against the labels that the camera equation gives."""

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from synth.__main__ import main
from synth.defects import outline
from synth.labels import _project, label, ring_px
from synth.optics import Optics
from synth.part import Hole, MissingWeld, Part, Truth, draw_part
from synth.recipe import Recipe
from synth.render import render
from synth.sensor import expose

pytestmark = pytest.mark.render


def calm() -> Part:
    """A part with little relief in the middle of the picture."""
    part = draw_part(3, Truth.OK, Recipe())
    return replace(part, center_mm=(0.0, 0.0), tilt_deg=(0.0, 0.0), ripple_slope=0.03, rough_slope=0.02)


def test_holes_are_dark_where_the_label_says() -> None:
    optics = Optics()
    part = replace(calm(), holes=(Hole(40.0, 0.0, 0.6, 0.3, 0.2, 3, 2), Hole(200.0, 0.1, 0.3, 0.3, 0.0, 4, 3)))
    x, y, _ = ring_px(part, optics)
    window = (int(x) - 520, int(y) - 520, 1040, 1040)
    image = render(part, optics, window, samples=8)
    bead = float(np.median(image[(520 - 440) : (520 - 415), 500:540]))
    for hole, defect in zip(part.holes, label(part, optics, "a", window[:2], window[2:])["defects"], strict=True):
        outlined = np.zeros(image.shape, np.uint8)
        points = _project(part, optics, *outline(hole, part)) - window[:2]
        cv2.fillPoly(outlined, [np.round(points).astype(np.int32)], 1)
        left, top, right, bottom = (round(v) for v in defect["bbox_px"])
        assert outlined.sum() == outlined[top : bottom + 1, left : right + 1].sum()
        core = cv2.erode(outlined, np.ones((5, 5))).astype(bool)
        rim = cv2.dilate(outlined, np.ones((21, 21))) - cv2.dilate(outlined, np.ones((9, 9)))
        assert (image[core] < 0.4 * bead).mean() > 0.98
        assert image[rim.astype(bool)].mean() > 2.5 * image[core].mean()


def test_a_missing_weld_shows_a_dark_joint_at_the_ring() -> None:
    optics = Optics()
    part = replace(calm(), missing=(MissingWeld(0.0, 360.0),))
    x, y, radius = ring_px(part, optics)
    window = (int(x) - 520, int(y) - 520, 1040, 1040)
    image = render(part, optics, window, samples=8)
    polar = cv2.warpPolar(image, (520, 720), (x - window[0], y - window[1]), 520, cv2.WARP_POLAR_LINEAR)
    darkest = polar[:, 380:470].argmin(axis=1) + 380
    assert np.median(darkest) == pytest.approx(radius, abs=1.5)


def test_same_part_same_picture() -> None:
    optics, part = Optics(), draw_part(5, Truth.HOLE, Recipe())
    window = (1900, 900, 160, 120)
    first, second = (expose(render(part, optics, window, samples=4), part, optics, window[:2]) for _ in range(2))
    assert (first == second).all()


def test_a_killed_lot_goes_on_and_another_seed_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["part", "--out", str(tmp_path), "--ring-only", "--seed", "5"]
    assert main([*command, "--count", "1"]) == 0
    (first,) = (tmp_path / "frames").glob("*.png")
    stamp = first.stat().st_mtime_ns
    assert main([*command, "--count", "2"]) == 0
    assert first.stat().st_mtime_ns == stamp
    assert len(json.loads((tmp_path / "labels.json").read_text())["frames"]) == 2
    assert main(["part", "--out", str(tmp_path), "--ring-only", "--seed", "6"]) == 2
    assert "another seed" in capsys.readouterr().err


@pytest.mark.parametrize(("arguments", "said"), [(["--count", "0"], "--count is 0"), (["--seed", "-1"], "--seed is -1")])
def test_mistakes_are_said_in_a_line(arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["part", "--out", str(tmp_path), *arguments]) == 2
    assert said in capsys.readouterr().err

"""Renders against the labels that the camera equation gives, and against Mitsuba's own integrator."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from synth.__main__ import main
from synth.camera.frames import band, frame_window, piece_crops, piece_window
from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.camera.render import mitsuba_scene, render, start
from synth.camera.scene import part_scene, window_pixels
from synth.defects.missing_weld import MissingWeld
from synth.measured.spectrum import WeldModel
from synth.output.labels import mask, outlines
from synth.output.plan import plan_pieces
from synth.part.geometry import StraightPiece
from synth.part.part import Part, draw_part
from synth.part.pose import Pose
from synth.part.switches import ALL, Switch
from synth.recipes.named import LINE, PAPER, WIDE
from tests.synth.welds import hole

pytestmark = pytest.mark.render
OPTICS = Optics()


def calm() -> Part:
    """A part with little relief in the middle of the picture."""
    part = draw_part(3, LINE)
    return replace(
        part,
        pose=Pose(center_mm=(0.0, 0.0), tilt_deg=(0.0, 0.0)),
        bead=replace(part.bead, offset_mm=0.0),
        relief=replace(part.relief, is_spectral=False, ripple_slope=0.03, rough_slope=0.02),
        dirt=replace(part.dirt, fibres=0, spatter=0, soot=0.0),
    )


def test_holes_open_exactly_where_the_label_says(model: WeldModel) -> None:
    part = replace(
        calm(),
        defects=(
            hole(40.0, length_mm=0.6, deformation=0.2),
            hole(300.0, offset_mm=0.1, length_mm=0.3, a=4, b=3),
        ),
        pose=Pose(center_mm=(1.0, -0.7), tilt_deg=(0.5, -0.4)),
    )
    scene = part_scene(part, model)
    for opening in outlines(part, OPTICS):
        left, top = np.floor(opening.points.min(axis=0)).astype(int) - 12
        width, height = np.ceil(np.ptp(opening.points, axis=0)).astype(int) + 24
        seen = render(scene, OPTICS, window_pixels(left, top, width, height), 16)
        floor, labelled = (
            seen.floor.reshape(height, width) > 0.5,
            mask(opening.points - (left, top), width, height),
        )
        assert labelled.sum() > 200
        assert (floor & labelled).sum() / (floor | labelled).sum() > 0.93
        ring = cv2.dilate(labelled.astype(np.uint8), np.ones((5, 5))) - cv2.erode(
            labelled.astype(np.uint8), np.ones((5, 5))
        )
        assert not ((floor != labelled) & (ring == 0)).any()
        radiance = seen.radiance.reshape(height, width)
        assert np.median(radiance[labelled]) < 0.3 * np.median(radiance[~labelled])


def test_the_bare_joint_is_masked_exactly(model: WeldModel) -> None:
    part = draw_part(8, PAPER, defects=(MissingWeld(-90.0, 90.0),), form=StraightPiece)
    _, _, floors = piece_crops([part], model, OPTICS)
    left, top, width, height = piece_window(OPTICS)
    (opening,) = outlines(part, OPTICS)
    labelled, floor = mask(opening.points - (left, top), width, height), floors[0] >= 0.5
    assert labelled[:, 0].any()
    assert labelled[:, -1].any()
    assert (floor & labelled).sum() / (floor | labelled).sum() > 0.85
    assert np.abs(floor.sum(axis=0) - labelled.sum(axis=0)).mean() < 0.5


def test_a_missing_weld_shows_a_dark_joint_at_the_ring(model: WeldModel) -> None:
    part = replace(calm(), defects=(MissingWeld(0.0, 360.0),))
    image, _, window = band(part, model, OPTICS)
    x, y, radius = ring_px(part, OPTICS)
    polar = cv2.warpPolar(image, (520, 720), (x - window[0], y - window[1]), 520, cv2.WARP_POLAR_LINEAR)
    darkest = polar[:, 380:470].argmin(axis=1) + 380
    assert np.median(darkest) == pytest.approx(radius, abs=1.5)


def test_the_light_is_that_of_mitsubas_own_integrator(model: WeldModel) -> None:
    """Same scene, the spots as point emitters: the sum over all, shadows included."""
    start()
    import mitsuba as mi

    part = replace(calm(), defects=(hole(270.0, length_mm=0.8, width_mm=0.5),))
    scene = part_scene(part, model)
    lights = scene.lights[0]
    points = replace(scene, lights=(replace(lights, sigma_rad=np.full(lights.sigma_rad.size, 1e6)),))
    window = (2060, 620, 80, 80)
    ours = render(points, OPTICS, window_pixels(*window), 64).radiance.reshape(80, 80)
    world: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0},
    }
    world |= {f"shape_{i}": shape for i, shape in enumerate(mitsuba_scene(scene).shapes())}
    for i, (at, value) in enumerate(zip(lights.positions_mm, lights.intensity, strict=True)):
        world[f"light_{i}"] = {
            "type": "point",
            "position": at.tolist(),
            "intensity": {"type": "uniform", "value": float(value)},
        }
    field = float(2 * np.rad2deg(np.arctan(OPTICS.width_px * OPTICS.pixel_mm / 2 / OPTICS.distance_mm)))
    film = {
        "type": "hdrfilm",
        "width": 4200,
        "height": 2160,
        "pixel_format": "luminance",
        "rfilter": {"type": "box"},
    }
    crop = dict(zip(("crop_offset_x", "crop_offset_y", "crop_width", "crop_height"), window, strict=True))
    view = mi.ScalarTransform4f().look_at(origin=[0, 0, OPTICS.distance_mm], target=[0, 0, 0], up=[0, 1, 0])
    sensor = mi.load_dict(
        {"type": "perspective", "fov": field, "fov_axis": "x", "to_world": view, "film": {**film, **crop}}
    )
    theirs = np.asarray(mi.render(mi.load_dict(world), sensor=sensor, spp=1024)).reshape(80, 80)
    small = [
        cv2.resize(np.asarray(v, np.float32), (8, 8), interpolation=cv2.INTER_AREA) for v in (ours, theirs)
    ]
    assert small[0] == pytest.approx(small[1], rel=0.04, abs=0.02 * float(theirs.mean()))


def test_each_switch_and_extra_changes_the_picture(model: WeldModel) -> None:
    (part,) = plan_pieces(5, {"ok": 1}, replace(PAPER, dirt=replace(PAPER.dirt, soot=(0.6, 0.6))), ALL)[
        0
    ].parts
    changed = [replace(part, switches=ALL - {s}) for s in Switch]
    dirt, bead, surface = part.dirt, part.bead, part.surface
    changed += [
        replace(part, dirt=replace(dirt, spatter=12)),
        replace(part, dirt=replace(dirt, fibres=6)),
        replace(part, dirt=replace(dirt, heat_tint=0.8)),
        replace(part, dirt=replace(dirt, bead_scratches=4)),
        replace(part, sensor=replace(part.sensor, veil=0.1)),
        replace(part, light=replace(part.light, second=1.0)),
        replace(part, bead=replace(bead, undercut_mm=0.03)),
        replace(part, bead=replace(bead, offset_mm=0.1)),
        replace(part, surface=replace(surface, material="copper")),
        replace(part, surface=replace(surface, alpha_weld=0.4)),
        replace(part, relief=replace(part.relief, is_spectral=False)),
    ]
    usual = piece_crops([part], model, OPTICS)[0][0].astype(int)
    for other in changed:
        difference = np.abs(piece_crops([other], model, OPTICS)[0][0].astype(int) - usual)
        assert difference.max() > 12, (other.switches ^ ALL, other)


def test_same_part_same_picture_wherever_it_is_rendered(model: WeldModel) -> None:
    part = draw_part(5, WIDE, kind="hole")
    window = (1900, 900, 160, 120)
    first, second = (frame_window(part, model, OPTICS, window) for _ in range(2))
    assert (first == second).all()


def test_a_killed_lot_goes_on_and_another_seed_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["part", "--out", str(tmp_path), "--ring-only", "--seed", "5", "--strips"]
    assert main([*command, "--count", "1"]) == 0
    (first,) = (tmp_path / "frames").glob("*.png")
    stamp = first.stat().st_mtime_ns
    assert main([*command, "--count", "2"]) == 0
    assert first.stat().st_mtime_ns == stamp
    assert len(json.loads((tmp_path / "labels.json").read_text())["frames"]) == 2
    for name in ("strips", "strip_masks"):
        assert cv2.imread(str(tmp_path / name / first.name), cv2.IMREAD_UNCHANGED).shape == (128, 2688)
    marked = cv2.imread(str(tmp_path / "masks" / first.name), cv2.IMREAD_UNCHANGED)
    label = json.loads((tmp_path / "labels.json").read_text())["frames"][0]
    assert marked.any() == bool(label["defects"])
    assert main(["part", "--out", str(tmp_path), "--ring-only", "--seed", "6"]) == 2
    assert "another seed" in capsys.readouterr().err

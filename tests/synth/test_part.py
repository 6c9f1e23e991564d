"""A part as data: drawn, outlined, meshed and labelled."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.defects.missing_weld import MissingWeld
from synth.measured.spectrum import WeldModel
from synth.output.labels import label
from synth.part.geometry import Ring, StraightPiece
from synth.part.part import Form, draw_part
from synth.part.switches import ALL, Switch
from synth.recipes.named import LINE, PAPER, RECIPES, WIDE
from synth.surface.contour import contour, overlap_weight
from synth.surface.mesh import part_meshes
from synth.surface.noise import perlin
from synth.surface.topography import relief
from tests.synth.welds import hole

SEEDS = st.integers(0, 10**6)
THETA = np.arange(4096) * (2 * np.pi / 4096)
KINDS = (None, *LINE.defects)


@given(SEEDS, st.sampled_from(KINDS))
def test_same_seed_same_part_of_the_requested_kind(seed: int, kind: str | None) -> None:
    part = draw_part(seed, LINE, kind=kind)
    assert part == draw_part(seed, LINE, kind=kind)
    assert part.kind == kind
    assert max(abs(v) for v in part.pose.center_mm) <= LINE.pose.shift_mm


@pytest.mark.parametrize("name", RECIPES)
def test_values_are_drawn_evenly_from_their_ranges(name: str) -> None:
    recipe = RECIPES[name]
    parts = [draw_part(seed, recipe) for seed in range(400)]
    seen = 0
    for group, ranges in recipe.groups().items():
        for field in fields(ranges) if group not in recipe.defects else ():
            bounds: Any = getattr(ranges, field.name)
            if not isinstance(bounds, tuple) or (group, field.name) == ("light", "second"):
                continue
            values = np.array([getattr(getattr(part, group), field.name) for part in parts])
            low, high = bounds
            assert low <= values.min() <= values.max() <= high, field.name
            if (group, field.name) == ("sensor", "exposure"):
                values, low, high = np.log(values), np.log(low), np.log(high)
            assert values.mean() == pytest.approx((low + high) / 2, abs=0.08 * (high - low) + 1e-12), (
                field.name
            )
            width = high - low + (1 if isinstance(bounds[0], int) else 0)
            assert values.std() == pytest.approx(width / 12**0.5, rel=0.12, abs=0.3 if width <= 2 else 1e-12)
            seen += 1
    assert seen > 35
    for value, limit in (("pose.center_mm", recipe.pose.shift_mm), ("pose.tilt_deg", recipe.pose.tilt_deg)):
        drawn = np.array([getattr(part.pose, value.split(".")[1]) for part in parts])
        assert np.abs(drawn).max() <= limit
        assert drawn.std() == pytest.approx(limit / 3**0.5, rel=0.1)
    spectral = np.mean([part.relief.is_spectral for part in parts])
    assert spectral == pytest.approx(recipe.relief.spectral_fraction, abs=0.08)
    second = np.mean([part.light.second > 0 for part in parts])
    assert second == pytest.approx(recipe.light.second_fraction, abs=0.08)
    assert {part.bead.direction for part in parts} == {-1, 1}


@given(SEEDS)
def test_the_ring_lies_where_the_camera_equation_puts_it(seed: int) -> None:
    part = draw_part(seed, LINE)
    x, y, radius = ring_px(part, Optics())
    assert x == pytest.approx(2099.5 + part.pose.center_mm[0] / 0.013, abs=0.5)
    assert y == pytest.approx(1079.5 + part.pose.center_mm[1] / 0.013, abs=0.5)
    assert radius == pytest.approx(part.bead.radius_mm / 0.013, rel=2e-3)


def test_pixel_pitch_is_13_um() -> None:
    a, b = Optics().project(np.array([[0.0, 0.0, 0.0], [0.013, -0.026, 0.0]]))
    assert b - a == pytest.approx([1.0, 2.0])
    assert a == pytest.approx([2099.5, 1079.5])


@given(
    st.sampled_from([Ring, StraightPiece]),
    st.floats(4.0, 7.0),
    st.floats(-3.0, 3.0),
    st.floats(-1.0, 1.0),
)
def test_weld_coordinates_are_the_inverse_of_embedding(
    form: Form, radius: float, angle: float, away: float
) -> None:
    geometry = form(radius)
    x, y, z = geometry.embed(np.array(angle), np.array(radius + away), np.array(0.25))
    assert z == 0.25
    found = geometry.weld_coordinates(np.array(x), np.array(y))
    assert found == pytest.approx((angle, radius + away), abs=1e-9)


@pytest.mark.parametrize("form", [Ring, StraightPiece])
def test_the_grid_covers_the_weld_evenly(form: Form) -> None:
    geometry = form(5.5)
    angles = geometry.angles()
    start, end = geometry.ends_rad
    steps = np.diff(angles)
    assert steps == pytest.approx(steps[0])
    assert angles[0] == start
    assert angles[-1] + (steps[0] if geometry.is_closed else 0) == pytest.approx(end)
    assert (end - start) * 5.5 == pytest.approx(geometry.length_mm)


@pytest.mark.parametrize("is_spectral", [True, False])
def test_relief_is_repeatable_and_closes_round_the_ring(is_spectral: bool, model: WeldModel) -> None:
    part = draw_part(4, LINE)
    part = replace(
        part,
        relief=replace(part.relief, is_spectral=is_spectral),
        bead=replace(part.bead, start_deg=180.0),
    )
    t = np.linspace(-1, 1, 32)
    z = relief(part, THETA, t, model)
    assert (z == relief(part, THETA, t, model)).all()
    assert 0.002 < z.std() < 0.1
    seam = np.abs(z[0] - z[-1]).mean()
    assert seam < 3 * np.abs(np.diff(z, axis=0)).mean()


@pytest.mark.parametrize("form", [Ring, StraightPiece])
def test_meshes_face_the_camera(form: Form, model: WeldModel) -> None:
    part = draw_part(2, WIDE, defects=(hole(3.0),), form=form)
    part = replace(
        part,
        dirt=replace(part.dirt, spatter=60, fibres=60),
        bead=replace(part.bead, crater_mm=0.0, overlap_mm=0.0),
    )
    meshes = part_meshes(part, model)
    assert set(meshes) == {"bead", "plate", "floor", "fibre"}
    for mesh in meshes.values():
        corner = mesh.vertices[mesh.faces].astype(np.float64)
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        assert (normal[:, 2] >= -1e-9).mean() > 0.999
        assert mesh.faces.max() < len(mesh.vertices)


def test_labels_of_a_window_are_those_of_the_frame_moved() -> None:
    optics, part = Optics(), draw_part(9, LINE, kind="hole")
    whole = label(part, optics, name="a", origin_px=(0, 0), size_px=(4200, 2160))
    window = label(part, optics, name="a", origin_px=(1000, 400), size_px=(1120, 1120))
    assert np.subtract(whole["center"], window["center"]) == pytest.approx([1000, 400])
    assert whole["defects"][0]["angle_deg"] == window["defects"][0]["angle_deg"]
    boxes = [labelled["defects"][0]["bbox_px"] for labelled in (whole, window)]
    assert np.subtract(*boxes) == pytest.approx([1000, 400, 1000, 400])


def test_a_part_is_called_by_its_gravest_defect() -> None:
    defects = (MissingWeld(100.0, 130.0), hole(40.0))
    part = draw_part(1, LINE, defects=defects)
    assert part.defects == defects
    assert part.kind == "missing_weld"
    labelled = label(part, Optics(), name="a", origin_px=(0, 0), size_px=(4200, 2160))
    assert [defect["kind"] for defect in labelled["defects"]] == ["missing_weld", "hole"]
    assert (labelled["verdict"], labelled["truth"]) == ("NOK", "missing_weld")


@pytest.mark.parametrize("bits", range(256))
def test_each_of_the_256_combinations_gives_a_weld(bits: int, model: WeldModel) -> None:
    on = frozenset(s for i, s in enumerate(Switch) if bits >> i & 1)
    part = draw_part(7, PAPER, form=StraightPiece, switches=on)
    theta, t = part.geometry.angles(), np.linspace(-1, 1, 24)
    z = relief(part, theta, t, model)
    assert np.isfinite(z).all()
    assert (z.std(axis=0).max() < 1e-9) == (not on & {Switch.TOPOGRAPHY, Switch.PERLIN})
    assert (abs(z[:, 0].mean()) < 0.5 * part.bead.crown_mm) == (Switch.REDUCED_EDGES in on)
    assert (np.ptp(contour(part, theta).outer_mm) > 1e-6) == (Switch.RANDOM_CONTOUR in on)


def test_perlin_noise_is_periodic_and_even() -> None:
    field = perlin(np.random.default_rng(0), (240, 160), (12, 8))
    assert np.abs(field).max() <= 1.01
    assert abs(field.mean()) < 0.1
    assert np.abs(field[0] - field[-1]).max() < 3 * np.abs(np.diff(field, axis=0)).max()
    assert np.abs(field[:, 0] - field[:, -1]).max() < 3 * np.abs(np.diff(field, axis=1)).max()
    assert field[::20, ::20] == pytest.approx(0)  # zero at the nodes, as gradient noise is


def test_the_weld_runs_twice_over_its_overlap() -> None:
    part = draw_part(1, LINE)
    part = replace(part, bead=replace(part.bead, overlap_mm=3.0, start_deg=0.0, direction=1))
    weight = overlap_weight(part, THETA)
    assert weight.sum() * (THETA[1] * part.bead.radius_mm) == pytest.approx(3.0, rel=0.05)
    assert weight[:1000].max() < 0.51
    assert ALL == part.switches


def test_the_papers_recipe_draws_what_the_paper_varies() -> None:
    for seed in range(30):
        part = draw_part(seed, PAPER)
        dirt = part.dirt
        assert part.relief.is_spectral
        assert (dirt.spatter, dirt.fibres, dirt.scratches, dirt.heat_tint) == (0, 0, 0, 0.0)
        assert (part.bead.crater_mm, part.surface.has_circles) == (0.0, False)

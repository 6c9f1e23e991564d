"""A part as data: drawn, outlined, meshed and labelled."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.defects.hole import hole_mask, outline
from synth.measured.spectrum import WeldModel
from synth.output.labels import label
from synth.part.geometry import Ring, StraightPiece
from synth.part.part import Form, Hole, Truth, draw_part
from synth.part.recipe import PAPER, WIDE, Recipe
from synth.part.switches import ALL, Switch
from synth.surface.contour import contour, overlap_weight
from synth.surface.mesh import part_meshes
from synth.surface.topography import relief

SEEDS = st.integers(0, 10**6)
THETA = np.arange(4096) * (2 * np.pi / 4096)


@given(SEEDS, st.sampled_from(list(Truth)))
def test_same_seed_same_part_of_the_wished_truth(seed: int, truth: Truth) -> None:
    part = draw_part(seed, truth, Recipe())
    assert part == draw_part(seed, truth, Recipe())
    assert part.truth is truth
    assert max(abs(v) for v in part.center_mm) <= Recipe().shift_mm


@given(SEEDS)
def test_the_ring_lies_where_the_camera_equation_puts_it(seed: int) -> None:
    optics = Optics()
    part = draw_part(seed, Truth.OK, Recipe())
    x, y, radius = ring_px(part, optics)
    assert x == pytest.approx(2099.5 + part.center_mm[0] / 0.013, abs=0.5)
    assert y == pytest.approx(1079.5 + part.center_mm[1] / 0.013, abs=0.5)
    assert radius == pytest.approx(part.radius_mm / 0.013, rel=2e-3)


def test_pixel_pitch_is_13_um() -> None:
    optics = Optics()
    a, b = optics.project(np.array([[0.0, 0.0, 0.0], [0.013, -0.026, 0.0]]))
    assert b - a == pytest.approx([1.0, 2.0])
    assert a == pytest.approx([2099.5, 1079.5])


@pytest.mark.parametrize("spectral", [True, False])
def test_relief_is_repeatable_and_closes_round_the_ring(spectral: bool, model: WeldModel) -> None:
    part = replace(draw_part(4, Truth.OK, Recipe()), spectral=spectral, start_deg=180.0)
    t = np.linspace(-1, 1, 32)
    z = relief(part, THETA, t, model)
    assert (z == relief(part, THETA, t, model)).all()
    assert 0.002 < z.std() < 0.1
    seam = np.abs(z[0] - z[-1]).mean()
    assert seam < 3 * np.abs(np.diff(z, axis=0)).mean()


@given(st.floats(0.1, 2.4), st.floats(0.1, 0.5), st.floats(0, 1), st.integers(3, 5), st.integers(2, 3), st.floats(0, 360))
def test_a_hole_is_as_long_and_wide_as_stated(length: float, width: float, d: float, a: int, b: int, angle: float) -> None:
    part = draw_part(1, Truth.OK, Recipe())
    at, radius = outline(Hole(angle, 0.0, length, width, d, a, b), part)
    assert np.ptp(at) * part.radius_mm == pytest.approx(length, rel=1e-6)
    assert np.ptp(radius) == pytest.approx(width, rel=1e-6)


def test_a_hole_at_the_seam_is_cut_on_both_sides() -> None:
    part = draw_part(1, Truth.OK, Recipe())
    part = replace(part, holes=(Hole(0.0, 0.0, 1.0, 0.3, 0.0, 3, 2),))
    mask = hole_mask(part, THETA, contour(part, THETA), 96)
    assert mask[:40].any()
    assert mask[-40:].any()
    assert not mask[1000:3000].any()


def test_no_bead_where_the_weld_is_missing() -> None:
    part = next(p for s in range(99) if (p := draw_part(s, Truth.MISSING_WELD, Recipe())).missing[0].end_deg < 360)
    line = contour(part, THETA)
    arc = part.missing[0]
    inside = (np.rad2deg(THETA) > arc.start_deg + 1) & (np.rad2deg(THETA) < arc.end_deg - 1)
    assert not line.present[inside].any()
    assert line.present.any()


@pytest.mark.parametrize("form", [Ring, StraightPiece])
def test_meshes_face_the_camera(form: Form, model: WeldModel) -> None:
    part = replace(draw_part(2, Truth.HOLE, WIDE, form=form), spatter=6, fibres=2, crater_mm=0.0, overlap_mm=0.0)
    meshes = part_meshes(part, model)
    assert set(meshes) == {"bead", "plate", "floor", "fibre"}
    for mesh in meshes.values():
        corner = mesh.vertices[mesh.faces].astype(np.float64)
        normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        assert (normal[:, 2] >= -1e-9).mean() > 0.999
        assert mesh.faces.max() < len(mesh.vertices)


def test_labels_of_a_window_are_those_of_the_frame_moved() -> None:
    optics, part = Optics(), draw_part(9, Truth.HOLE, Recipe())
    whole = label(part, optics, "a", (0, 0), (4200, 2160))
    window = label(part, optics, "a", (1000, 400), (1120, 1120))
    assert np.subtract(whole["center"], window["center"]) == pytest.approx([1000, 400])
    assert whole["defects"][0]["angle_deg"] == window["defects"][0]["angle_deg"]
    assert np.subtract(whole["defects"][0]["bbox_px"], window["defects"][0]["bbox_px"]) == pytest.approx([1000, 400, 1000, 400])


def test_a_part_shows_holes_and_missing_welds_together() -> None:
    hole, arc = (
        Hole(40.0, 0.0, 0.6, 0.3, 0.2, 3, 2),
        next(p.missing for s in range(99) if (p := draw_part(s, Truth.MISSING_WELD, Recipe())).missing[0].end_deg < 360),
    )
    part = draw_part(1, Truth.OK, Recipe(), defects=((hole,), arc))
    assert part.holes == (hole,)
    assert part.missing == arc
    assert part.truth is Truth.MISSING_WELD


@pytest.mark.parametrize("bits", range(256))
def test_each_of_the_256_combinations_gives_a_weld(bits: int, model: WeldModel) -> None:
    on = frozenset(s for i, s in enumerate(Switch) if bits >> i & 1)
    part = draw_part(7, Truth.OK, PAPER, on, form=StraightPiece)
    theta, t = part.geometry.angles(), np.linspace(-1, 1, 24)
    z = relief(part, theta, t, model)
    assert np.isfinite(z).all()
    assert (z.std(axis=0).max() < 1e-9) == (not on & {Switch.TOPOGRAPHY, Switch.PERLIN})
    assert (abs(z[:, 0].mean()) < 0.5 * part.crown_mm) == (Switch.REDUCED_EDGES in on)
    assert (np.ptp(contour(part, theta).outer_mm) > 1e-6) == (Switch.RANDOM_CONTOUR in on)


def test_perlin_noise_is_periodic_and_even() -> None:
    from synth.surface.noise import perlin

    field = perlin(np.random.default_rng(0), (240, 160), (12, 8))
    assert np.abs(field).max() <= 1.01
    assert abs(field.mean()) < 0.1
    assert np.abs(field[0] - field[-1]).max() < 3 * np.abs(np.diff(field, axis=0)).max()
    assert np.abs(field[:, 0] - field[:, -1]).max() < 3 * np.abs(np.diff(field, axis=1)).max()
    assert field[::20, ::20] == pytest.approx(0)  # zero at the nodes, as gradient noise is


def test_the_weld_runs_twice_over_its_overlap() -> None:
    part = replace(draw_part(1, Truth.OK, Recipe()), overlap_mm=3.0, start_deg=0.0, direction=1)
    weight = overlap_weight(part, THETA)
    assert weight.sum() * (THETA[1] * part.radius_mm) == pytest.approx(3.0, rel=0.05)
    assert weight[:1000].max() < 0.51
    assert ALL == part.switches

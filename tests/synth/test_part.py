import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from synth.defects import hole_mask, outline
from synth.labels import label, ring_px
from synth.mesh import part_meshes
from synth.optics import Optics
from synth.part import Hole, Truth, draw_part
from synth.recipe import Recipe
from synth.topography import contour, relief

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


def test_relief_is_repeatable_and_closes_round_the_ring() -> None:
    part = draw_part(4, Truth.OK, Recipe())
    t = np.linspace(-1, 1, 32)
    z = relief(part, THETA, t)
    assert (z == relief(part, THETA, t)).all()
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
    from dataclasses import replace

    part = replace(part, holes=(Hole(0.0, 0.0, 1.0, 0.3, 0.0, 3, 2),))
    mask = hole_mask(part, THETA, contour(part, THETA).center_mm, part.half_width_mm, 96)
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


def test_meshes_face_the_camera() -> None:
    for mesh in part_meshes(draw_part(2, Truth.HOLE, Recipe())).values():
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

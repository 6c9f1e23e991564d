"""Kinds of defect: one module each, what they draw, cut and leave of the bead."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import synth.defects
from station.defects import KINDS
from synth.defects.hole import Hole, HoleRanges
from synth.defects.kinds import RANGES, ranges_of
from synth.defects.missing_weld import MissingWeld, MissingWeldRanges
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.lot import plan
from synth.part.bead import Bead
from synth.part.geometry import StraightPiece
from synth.part.part import draw_part
from synth.recipes.named import LINE, RECIPES, WIDE
from synth.surface.contour import bead_width, contour
from synth.surface.mesh import ACROSS, part_meshes
from tests.synth.welds import hole

THETA = np.arange(4096) * (2 * np.pi / 4096)
NAMES = [kind.name for kind in KINDS]


def bead() -> Bead:
    return LINE.bead.draw(np.random.default_rng(1))


def test_each_kind_has_a_module_and_each_module_is_a_kind() -> None:
    assert list(RANGES) == NAMES
    folder = Path(synth.defects.__file__).parent
    modules = {path.stem for path in folder.glob("*.py")} - {"__init__", "kinds"}
    assert modules == set(NAMES)
    for recipe in RECIPES.values():
        assert list(recipe.defects) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_kind_draws_itself_in_every_way(name: str) -> None:
    for recipe in RECIPES:
        ranges, rng = ranges_of(recipe)[name], np.random.default_rng(3)
        assert not ranges.draw_on_ring(rng, bead(), 0.0)
        for drawn in (
            ranges.draw(rng, bead()),
            ranges.draw_on_piece(rng, bead()),
            ranges.draw_on_ring(rng, bead(), 0.8),
        ):
            assert drawn
            for defect in drawn:
                assert defect.kind == name
                start, end = defect.span_deg(bead())
                assert start < end <= start + 360
                assert all(size > 0 for size in defect.size_mm(bead()))


@pytest.mark.parametrize("name", NAMES)
def test_what_is_drawn_for_a_piece_is_seen_on_it(name: str) -> None:
    for seed in range(60):
        defects = LINE.defects[name].draw_on_piece(np.random.default_rng(seed), bead())
        part = draw_part(seed, LINE, defects=defects, form=StraightPiece)
        borders = contour(part, part.geometry.angles())
        start, end = part.geometry.ends_rad
        for defect in part.defects:
            angle, radius = defect.outline(borders)
            assert angle.size == radius.size
            assert angle.max() > 0.8 * start
            assert angle.min() < 0.8 * end


def test_a_lot_has_the_weights_of_its_recipe() -> None:
    kinds = [kind for _, kind in plan(3, 2000, LINE)]
    assert len(set(plan(3, 2000, LINE))) == 2000
    total = LINE.ok_weight + sum(ranges.weight for ranges in LINE.defects.values())
    assert kinds.count(None) / 2000 == pytest.approx(LINE.ok_weight / total, abs=0.04)
    for name, ranges in LINE.defects.items():
        assert kinds.count(name) / 2000 == pytest.approx(ranges.weight / total, abs=0.04)
    none = {name: replace(ranges, weight=0.0) for name, ranges in LINE.defects.items()}
    with pytest.raises(SynthError, match="weights of all kinds of defect are 0"):
        next(plan(3, 1, replace(LINE, ok_weight=0.0, defects=none)))


def test_a_new_kind_changes_no_other_draw() -> None:
    usual, more = LINE, replace(LINE, defects={**LINE.defects, "dent": HoleRanges(weight=5.0)})
    for seed in range(20):
        for kind in (None, *NAMES):
            assert draw_part(seed, more, kind=kind) == draw_part(seed, usual, kind=kind)
    dents, holes = draw_part(1, more, kind="dent").defects, draw_part(1, more, kind="hole").defects
    assert dents[0] != holes[0]


@given(
    st.floats(0.1, 2.4),
    st.floats(0.1, 0.5),
    st.floats(0, 1),
    st.integers(3, 5),
    st.integers(2, 3),
    st.floats(0, 360),
)
def test_a_hole_is_as_long_and_wide_as_stated(
    length: float, width: float, d: float, a: int, b: int, angle: float
) -> None:
    planted = hole(angle, length_mm=length, width_mm=width, deformation=d, a=a, b=b)
    part = draw_part(1, LINE)
    at, radius = planted.outline(contour(part, np.linspace(0, 1, 8)))
    assert np.ptp(at) * part.bead.radius_mm == pytest.approx(length, rel=1e-6)
    assert np.ptp(radius) == pytest.approx(width, rel=1e-6)
    start, end = planted.span_deg(part.bead)
    assert np.rad2deg([at.min(), at.max()]) == pytest.approx([start, end])


def test_holes_are_drawn_from_their_ranges() -> None:
    ranges = HoleRanges(count=(2, 4), length_mm=(0.1, 0.4), rim_mm=(0.02, 0.03))
    parts = [ranges.draw(np.random.default_rng(seed), bead()) for seed in range(300)]
    assert {len(holes) for holes in parts} == {2, 3, 4}
    lengths = np.log([h.length_mm for holes in parts for h in holes])
    assert np.log(0.1) <= lengths.min() <= lengths.max() <= np.log(0.4)
    assert lengths.mean() == pytest.approx(np.log(0.2), abs=0.08)
    for holes in parts:
        assert len({h.rim for h in holes}) == 1
        assert all(0.02 <= h.rim.sink_mm <= 0.03 for h in holes)
        assert all(abs(h.offset_mm) + h.width_mm / 2 <= 0.76 * bead().half_width_mm for h in holes)


def test_arcs_are_drawn_from_their_ranges() -> None:
    ranges = MissingWeldRanges(arc_deg=(20.0, 30.0), all_round_fraction=0.25)
    parts = [ranges.draw(np.random.default_rng(seed), bead()) for seed in range(400)]
    spans = [[arc.end_deg - arc.start_deg for arc in arcs] for arcs in parts]
    assert np.mean([span == [360.0] for span in spans]) == pytest.approx(0.25, abs=0.06)
    firsts = [span[0] for span in spans if span != [360.0]]
    assert 20 <= min(firsts) <= max(firsts) <= 30
    assert np.mean(firsts) == pytest.approx(25, abs=0.6)


def test_a_hole_at_the_seam_is_cut_on_both_sides() -> None:
    part = draw_part(1, LINE, defects=(hole(0.0),))
    cells = part.defects[0].cut(contour(part, THETA), 96)
    assert cells is not None
    assert cells[:40].any()
    assert cells[-40:].any()
    assert not cells[1000:3000].any()


def test_the_melt_sinks_round_a_hole_and_nowhere_else() -> None:
    part = draw_part(1, LINE, defects=(hole(90.0),))
    raised = part.defects[0].raise_mm(contour(part, THETA), 96)
    assert raised is not None
    assert raised.min() == pytest.approx(-0.03, rel=0.01)
    assert raised.max() <= 0
    assert np.abs(raised[2500:]).max() < 1e-6


def test_no_bead_where_the_weld_is_missing() -> None:
    arc = MissingWeld(300.0, 410.0)
    part = draw_part(1, LINE, defects=(arc,))
    borders = contour(part, THETA)
    degrees = np.rad2deg(THETA)
    inside = (degrees > 301) | (degrees < 49)
    assert not borders.present[inside].any()
    assert borders.present[(degrees > 55) & (degrees < 295)].all()
    assert bead_width(part, np.deg2rad(np.array([355.0, 180.0]))).tolist() == [0.0, 1.0]


def test_a_part_without_weld_has_no_bead_mesh(model: WeldModel) -> None:
    part = draw_part(1, WIDE, defects=(MissingWeld(0.0, 360.0),))
    assert "bead" not in part_meshes(part, model)


def test_a_missing_weld_beside_a_straight_piece_has_no_outline() -> None:
    part = draw_part(1, LINE, defects=(MissingWeld(20.0, 90.0),), form=StraightPiece)
    angle, radius = part.defects[0].outline(contour(part, part.geometry.angles()))
    assert angle.size == radius.size == 0


def test_a_hole_leaves_the_bead_its_width_and_a_missing_weld_its_relief() -> None:
    part = draw_part(1, LINE, defects=(hole(90.0), MissingWeld(10.0, 60.0)))
    borders = contour(part, part.geometry.angles())
    found, arc = part.defects
    assert isinstance(found, Hole)
    assert found.shape(borders.theta_rad, part.bead) is None
    assert arc.cut(borders, ACROSS) is None
    assert arc.raise_mm(borders, ACROSS) is None

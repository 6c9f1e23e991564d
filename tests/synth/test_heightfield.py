"""The second renderer: what it draws is where its labels say, and the same for the same seed."""

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.errors import SynthError
from synth.heightfield.holes import FAMILIES as HOLES
from synth.heightfield.part import ORDERS, most_frequent, picture
from synth.heightfield.shade import ROUGHNESSES, Light, shade, table
from synth.heightfield.sheet import FINISHES
from synth.heightfield.surface import Place
from synth.heightfield.weld import FAMILIES as WELDS
from synth.output.pictures import write_pictures

SMALL = replace(ORDERS["ring"], factor=1, side_mm=16.0, radius_mm=(3.5, 5.5), shift_mm=1.0)


def _away_mm(pictured) -> np.ndarray:  # type: ignore[no-untyped-def]
    side = pictured.image.shape[0]
    at_mm = (np.arange(side) - (side - 1) / 2) * SMALL.um_per_px / 1000
    x, y = np.meshgrid(at_mm, at_mm)
    course = pictured.course
    return np.asarray(np.hypot(x - course.x_mm, y - course.y_mm) - course.radius_mm)


@pytest.mark.parametrize("sheet", FINISHES)
def test_every_finish_draws_a_picture_of_some_contrast(sheet: str) -> None:
    drawn = picture(1, replace(SMALL, sheets=(sheet,), no_weld=0.0))

    assert drawn.sheet == sheet
    assert drawn.image.dtype == np.uint8
    assert drawn.image.std() > 2


@pytest.mark.parametrize("weld", WELDS)
def test_every_weld_lies_on_its_circle(weld: str) -> None:
    drawn = picture(5, replace(SMALL, welds=(weld,), no_weld=0.0, missing=0.0, holes=0.0))

    assert drawn.weld == weld
    assert drawn.course is not None
    away = _away_mm(drawn)
    middle = np.abs(away) < 0.5 * drawn.course.half_width_mm
    assert np.mean(drawn.place[middle] == Place.BEAD) > 0.99
    near = np.abs(away) < 2.5 * drawn.course.half_width_mm
    beside = near & (np.abs(away) > 1.7 * drawn.course.half_width_mm)
    assert not np.any(drawn.place[beside] == Place.BARE_JOINT)


@pytest.mark.parametrize("family", HOLES)
def test_every_hole_lies_in_the_bead_and_inside_its_arc(family: str) -> None:
    order = replace(SMALL, um_per_px=26.0, no_weld=0.0, missing=0.0, holes=1.0, hole_families=(family,))
    drawn = picture(3, order)
    assert drawn.course is not None
    assert drawn.holes
    rows, columns = np.nonzero(drawn.place == Place.HOLE)
    assert rows.size
    half = (drawn.image.shape[0] - 1) / 2
    x = (columns - half) * 0.026 - drawn.course.x_mm
    y = (rows - half) * 0.026 - drawn.course.y_mm
    degrees = np.rad2deg(np.arctan2(y, x))
    margin = 6.0  # the outline is uneven, and 0.1 mm is 1 to 2 degrees
    covered = np.zeros(rows.size, bool)
    for hole in drawn.holes:
        covered |= (degrees - hole.start_deg + margin) % 360 <= hole.end_deg - hole.start_deg + 2 * margin
    assert covered.all()


def test_a_missing_bead_shows_its_joint() -> None:
    drawn = picture(11, replace(SMALL, no_weld=0.0, missing=1.0, holes=0.0))

    assert drawn.course is not None
    assert drawn.course.missing_deg
    assert np.any(drawn.place == Place.BARE_JOINT)


def test_without_a_weld_nothing_is_marked_on_the_ring() -> None:
    drawn = picture(4, replace(SMALL, no_weld=1.0))

    assert drawn.course is None
    assert not np.any(drawn.place == Place.BARE_JOINT)


@given(st.integers(1, 4), st.integers(0, 10_000))
@settings(max_examples=30)
def test_the_mask_of_a_pixel_is_that_of_most_of_its_cells(factor: int, seed: int) -> None:
    cells = np.random.default_rng(seed).integers(0, 4, (6 * factor, 5 * factor), dtype=np.uint8)
    mask = most_frequent(cells, factor)
    assert mask.shape == (6, 5)
    for row in range(6):
        for column in range(5):
            block = cells[row * factor : (row + 1) * factor, column * factor : (column + 1) * factor]
            counts = np.bincount(block.ravel(), minlength=4)
            assert counts[mask[row, column]] == counts.max()


@pytest.mark.parametrize("factor", [1, 2, 3, 4])
def test_a_mask_is_not_moved_against_the_mean_of_its_cells(factor: int, rng: np.random.Generator) -> None:
    rows, columns = (np.indices((60 * factor, 60 * factor)) + 0.5) / factor - 0.5
    moved = []
    for x_px, y_px in rng.uniform(25, 35, (60, 2)):
        mask = most_frequent((np.hypot(columns - x_px, rows - y_px) < 20).astype(np.uint8), factor)
        found_rows, found_columns = np.nonzero(mask)
        moved.append((found_columns.mean() - x_px, found_rows.mean() - y_px))
    # a single mask is of whole pixels; many of them show whether they are moved
    assert np.mean(moved, axis=0) == pytest.approx((0.0, 0.0), abs=0.03)


def test_the_same_seed_gives_the_same_picture_and_another_one_does_not() -> None:
    first, again, other = picture(8, SMALL), picture(8, SMALL), picture(9, SMALL)

    assert np.array_equal(first.image, again.image)
    assert np.array_equal(first.place, again.place)
    assert not np.array_equal(first.image, other.image)


def test_a_mirror_sends_up_only_what_comes_from_above() -> None:
    overhead = Light(np.array([[0.0, 0.0, 1.0]]), np.array([1.0]), 0.0)
    sent = table(overhead, ROUGHNESSES[0])
    row, column = np.unravel_index(int(sent.argmax()), sent.shape)

    assert (row, column) == (sent.shape[0] // 2, sent.shape[1] // 2)
    assert sent[0, sent.shape[1] // 2] < 1e-3 * sent.max()


def test_a_slope_towards_the_light_is_brighter_than_one_away_from_it() -> None:
    x, y = np.meshgrid(*(np.linspace(-1, 1, 64, dtype=np.float32),) * 2)
    direction = np.array([[0.4, 0.0, 1.0]]) / np.hypot(0.4, 1.0)
    light = Light(direction, np.array([1.0]), 0.0)
    rough = np.full_like(x, 0.2)
    towards, away = (
        shade(np.asarray(slope * x, np.float32), rough, light, x, y).mean() for slope in (-0.2, 0.2)
    )

    assert towards > 2 * away


def test_a_lot_continues_where_it_stopped_and_says_where_the_weld_is(tmp_path: Path) -> None:
    done: list[int] = []
    order = replace(SMALL, no_weld=0.0)
    for _ in range(2):
        write_pictures(tmp_path, order, seed=2, count=3, workers=1, done=lambda: done.append(1))
    labels = json.loads((tmp_path / "labels.json").read_text())

    assert len(done) == 6
    assert labels["um_per_px"] == 52.0
    for label in labels["frames"]:
        image = cv2.imread(str(tmp_path / "frames" / label["frame"]), cv2.IMREAD_UNCHANGED)
        place = cv2.imread(str(tmp_path / "masks" / label["frame"]), cv2.IMREAD_UNCHANGED)
        assert image.shape == place.shape == tuple(label["size"][::-1])
        rows, columns = np.nonzero((place == Place.BEAD) | (place == Place.HOLE))
        away = np.abs(np.hypot(columns - label["center"][0], rows - label["center"][1]) - label["radius"])
        assert np.median(away) < label["bead_halfwidth_mm"] * 1000 / 52.0
    with pytest.raises(SynthError, match="another seed"):
        write_pictures(tmp_path, order, seed=3, count=3, workers=1, done=lambda: None)


def test_what_is_harsh_changes_only_the_pictures_that_are() -> None:
    mild, harsh = replace(SMALL, harsh=0.0, bare=0.0), replace(SMALL, harsh=1.0, bare=0.0)

    assert not np.array_equal(picture(8, mild).image, picture(8, harsh).image)
    assert np.array_equal(picture(8, mild).image, picture(8, replace(mild, harsh=1e-9)).image)


def test_a_plug_changes_only_the_pictures_that_have_one() -> None:
    without, some, plug = (replace(SMALL, no_weld=0.0, plugs=fraction) for fraction in (0.0, 1e-9, 1.0))

    assert np.array_equal(picture(8, without).image, picture(8, some).image)
    assert not np.array_equal(picture(8, without).image, picture(8, plug).image)


def test_the_zones_of_a_plug_lie_within_the_bead() -> None:
    order = replace(ORDERS["plugs"], factor=1, missing=0.0, holes=0.0, no_weld=0.0, harsh=0.0)
    beside = replace(order, plugs=0.0)
    turned, plain = picture(21, order), picture(21, beside)
    assert turned.course == plain.course
    course = turned.course
    assert course is not None
    side = turned.image.shape[0]
    at_mm = (np.arange(side) - (side - 1) / 2) * order.um_per_px / 1000
    away = np.hypot(*np.meshgrid(at_mm - course.x_mm, at_mm - course.y_mm)) - course.radius_mm
    on_ring = np.abs(away) < 0.5 * course.half_width_mm

    assert np.mean(turned.place[on_ring] == Place.BEAD) > 0.99
    inside = away < -1.4 * course.half_width_mm
    assert not np.isin(turned.place[inside], (Place.BEAD, Place.HOLE)).any()


def test_a_bare_part_shows_its_joint_all_round() -> None:
    drawn = picture(12, replace(SMALL, no_weld=0.0, holes=0.0, bare=1.0, harsh=0.0))

    assert not np.any(drawn.place == Place.BEAD)
    assert np.any(drawn.place == Place.BARE_JOINT)

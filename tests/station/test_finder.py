"""The steps of locate behind the network, on marks drawn as a perfect network would give them."""

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.domain import Image
from station.errors import LocateError
from station.vision.locate import MIN_SUPPORT, Expected, Located, MarkFinder, locate
from station.vision.marks import Marks
from station.vision.polar import SECTORS, read_sectors
from station.vision.reduced import FINDER_UM_PER_PX, Circle, reduce_to_finder
from tests.station.marks import BEAD_PX, JOINT_PX, arc, finder, marks_of, parts_of

EXPECTED = Expected(radius_mm=5.564, tolerance_mm=0.156)
SCALES_UM = st.sampled_from([9.0, 13.0, 17.3, 26.0, 40.0, 52.0, 65.0])
SHAPE = (540, 1050)
"""Height and width of a frame of the line at 52 µm/px."""


def search(find: MarkFinder, shape: tuple[int, int] = SHAPE) -> Located:
    return locate(np.zeros(shape, np.uint8), EXPECTED, find, um_per_px=FINDER_UM_PER_PX)


def partly(start: float, fraction: float, *, joint: bool = False, moved: float = 0.0) -> MarkFinder:
    """A bead on a part of the circle (500, 260, 107.3) and, if asked, a joint on the rest, moved in x."""

    def find(picture: Image) -> Marks:
        x, y = parts_of(picture)
        angle = (np.arctan2(y - 260, x - 500) / (2 * np.pi) - start) % 1
        bead = arc(x, y, circle=(500, 260, 107.3), half=BEAD_PX) * (angle < fraction)
        bare = arc(x, y, circle=(500 + moved, 260, 107.3), half=JOINT_PX) * (angle >= fraction)
        return marks_of(bead, bare if joint else 0 * bare)

    return find


@given(st.floats(140, 900), st.floats(135, 400), st.floats(104.2, 109.8))
@settings(max_examples=40)
def test_a_whole_bead_is_found_to_a_fiftieth_of_a_cell(x: float, y: float, radius: float) -> None:
    found = search(finder((x, y, radius)))
    assert np.hypot(found.ring.center_x_px - x, found.ring.center_y_px - y) < 0.08
    assert abs(found.ring.radius_px - radius) < 0.08
    assert found.ring.support == 1.0
    assert found.ring.residual_px < 0.2
    assert (found.presence > 0.9).all()


@given(st.floats(0, 1), st.floats(0.62, 0.98))
@settings(max_examples=30)
def test_two_fifths_of_the_circle_may_be_hidden(start: float, fraction: float) -> None:
    found = search(partly(start, fraction))
    assert np.hypot(found.ring.center_x_px - 500, found.ring.center_y_px - 260) < 0.3
    assert abs(found.ring.radius_px - 107.3) < 0.3
    assert found.ring.support == pytest.approx(fraction, abs=0.03)
    middle = (np.arange(SECTORS) + 0.5) / SECTORS
    inside = (middle - start) % 1
    assert (found.presence[(inside > 0.02) & (inside < fraction - 0.02)] > 0.5).all()
    assert (found.presence[(inside > fraction + 0.02) & (inside < 0.98)] < 0.5).all()


@given(st.floats(0, 1), st.floats(0.05, MIN_SUPPORT - 0.05))
@settings(max_examples=20)
def test_less_than_the_minimum_support_is_no_weld(start: float, fraction: float) -> None:
    with pytest.raises(LocateError, match="no weld found: "):
        search(partly(start, fraction))


@given(st.floats(0.6, 1.0))
@settings(max_examples=10)
def test_nothing_but_a_bare_joint_is_found(coverage: float) -> None:
    def find(picture: Image) -> Marks:
        x, y = parts_of(picture)
        joint = coverage * arc(x, y, circle=(500, 260, 107.3), half=JOINT_PX)
        return marks_of(0 * joint, joint)

    found = search(find)
    assert np.hypot(found.ring.center_x_px - 500, found.ring.center_y_px - 260) < 0.2
    assert found.ring.support > 0.95


@given(st.floats(0, 1), st.floats(0.5, 0.9), st.floats(-1.2, 1.2))
@settings(max_examples=30)
def test_a_joint_beside_the_bead_is_seen_but_hardly_moves_the_circle(
    start: float, fraction: float, moved: float
) -> None:
    found = search(partly(start, fraction, joint=True, moved=moved))
    assert found.ring.support > 0.95
    assert np.hypot(found.ring.center_x_px - 500, found.ring.center_y_px - 260) < 0.5 + 0.5 * abs(moved)


def test_a_joint_that_is_bare_all_around_is_found() -> None:
    found = search(partly(0.0, 0.0, joint=True))
    assert found.ring.support == 1.0
    assert found.ring.radius_px == pytest.approx(107.3, abs=0.2)


@pytest.mark.parametrize("radius_mm", [1.6, 2.9, 4.1, 6.3, 7.4, 8.7])
def test_a_ring_of_another_radius_is_named(radius_mm: float) -> None:
    with pytest.raises(LocateError, match=r"no weld found: a ring of") as caught:
        search(finder((520, 265, radius_mm * 1000 / FINDER_UM_PER_PX)))
    words = str(caught.value)
    assert float(words.split("a ring of ")[1].split(" mm")[0]) == pytest.approx(radius_mm, abs=0.02)
    assert words.endswith("expected 5.56 +- 0.16 mm")


def test_other_rings_do_not_draw_the_circle_away() -> None:
    found = search(finder((500, 260, 107), (503, 262, 60), (495, 255, 150), (640, 330, 40)))
    assert (found.ring.center_x_px, found.ring.center_y_px) == pytest.approx((500, 260), abs=0.2)


def test_nothing_is_no_weld_and_the_error_says_how_little_was_seen() -> None:
    with pytest.raises(LocateError, match=r"no weld found: the best circle scores .*minimum is"):
        search(finder())


@pytest.mark.parametrize("place", [(118, 260), (932, 260), (500, 118), (500, 425)])
def test_a_ring_whose_strip_leaves_the_image_is_out_of_view(place: tuple[float, float]) -> None:
    with pytest.raises(LocateError, match="not wholly in view") as caught:
        search(finder((*place, 107)))
    assert caught.value.out_of_view


@given(SCALES_UM, st.floats(-300, 300), st.floats(-150, 150))
@settings(max_examples=30)
def test_the_ring_is_in_pixels_of_the_frame_at_any_scale(
    um_per_px: float, dx_um: float, dy_um: float
) -> None:
    """The frame itself is drawn, and the network replaced by one that takes its grey levels as coverage."""
    side = round(16_000 / um_per_px)
    x, y, radius = side / 2 + dx_um / um_per_px, side / 2 + dy_um / um_per_px, 5_564 / um_per_px
    rows, columns = np.indices((side, side))
    away = np.abs(np.hypot(columns - x, rows - y) - radius) * um_per_px
    frame = np.asarray(255 * np.clip((420 - away) / um_per_px + 0.5, 0, 1), np.uint8)

    def find(picture: Image) -> Marks:
        height, width = picture.shape
        padded = np.pad(picture, ((0, -height % 16), (0, -width % 16))) / 255
        bead = padded.reshape(padded.shape[0] // 2, 2, -1, 2).mean(axis=(1, 3))
        return marks_of(bead, 0 * bead)

    ring = locate(frame, EXPECTED, find, um_per_px=um_per_px).ring
    assert np.hypot(ring.center_x_px - x, ring.center_y_px - y) * um_per_px < 8
    assert abs(ring.radius_px - radius) * um_per_px < 8


@given(st.integers(20, 90), st.integers(20, 90), st.sampled_from([13.0, 20.0, 26.0, 52.0, 65.0]))
@settings(max_examples=40)
def test_a_reduced_frame_keeps_its_places(height: int, width: int, um_per_px: float) -> None:
    frame = np.zeros((height, width), np.uint8)
    reduced = reduce_to_finder(frame, um_per_px)
    rows, columns = reduced.image.shape
    top = reduced.in_frame(Circle(-0.5, -0.5, 1.0))
    end = reduced.in_frame(Circle(columns - 0.5, rows - 0.5, 1.0))
    assert (top.x, top.y) == pytest.approx((-0.5, -0.5))
    lost = FINDER_UM_PER_PX / um_per_px
    assert width - 0.5 - lost < end.x <= width - 0.5 + 1e-9
    assert height - 0.5 - lost < end.y <= height - 0.5 + 1e-9


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(-3, 3))
@settings(max_examples=30)
def test_sectors_say_where_the_centre_line_is(dx: float, dy: float, dr: float) -> None:
    marks = finder((150 + dx, 140 + dy, 100 + dr))(np.zeros((288, 304), np.uint8))
    sectors = read_sectors(marks, Circle(150, 140, 100))
    angle = (np.arange(SECTORS) + 0.5) * 2 * np.pi / SECTORS
    true = dx * np.cos(angle) + dy * np.sin(angle) + dr
    assert np.abs(sectors.middle - true).max() < 0.35
    assert (sectors.presence > 0.95).all()


def test_sectors_beyond_the_picture_show_nothing() -> None:
    marks = finder((60, 140, 100))(np.zeros((288, 304), np.uint8))
    sectors = read_sectors(marks, Circle(60, 140, 100))
    angle = (np.arange(SECTORS) + 0.5) * 2 * np.pi / SECTORS
    left = 60 + 100 * np.cos(angle)
    assert (sectors.presence[left < -10] == 0).all()
    assert (sectors.presence[left > 10] > 0.9).all()


@given(st.integers(0, 10_000), st.floats(0, 1), st.integers(0, 30))
@settings(max_examples=40)
def test_any_marks_give_a_ring_of_the_expected_radius_or_an_error(
    seed: int, density: float, grain: int
) -> None:
    """Noise of any density and grain never fails otherwise, nor gives a ring outside of the tolerance."""
    rng = np.random.default_rng(seed)

    def find(picture: Image) -> Marks:
        parts = parts_of(picture)[0].shape
        noise = rng.random((2, *parts), dtype=np.float32)
        if grain:
            noise = np.stack([cv2.blur(field, (grain, grain)) for field in noise])
        return marks_of(*(noise < np.quantile(noise, density)).astype(np.float64))

    try:
        found = search(find, (320, 340))
    except LocateError:
        return
    assert abs(found.ring.radius_px * 0.052 - EXPECTED.radius_mm) <= EXPECTED.tolerance_mm + 1e-6
    assert found.ring.support >= MIN_SUPPORT

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_COLUMNS, STRIP_ROWS, TRAINED_UM_PER_PX, Ring
from station.errors import LocateError
from station.vision.unwrap import frame_to_strip, in_view, segments, strip_to_frame, unwrap

RINGS = st.builds(Ring, st.floats(600, 3600), st.floats(600, 1500), st.floats(400, 450), st.just(1.0))
SCALES = st.floats(*TRAINED_UM_PER_PX)


@given(
    RINGS,
    SCALES,
    st.lists(
        st.tuples(st.floats(-0.49, STRIP_COLUMNS - 0.51), st.floats(0, STRIP_ROWS - 1)),
        min_size=1,
        max_size=20,
    ),
)
def test_strip_to_frame_and_back_is_exact_at_any_scale(
    ring: Ring, um_per_px: float, points: list[tuple[float, float]]
) -> None:
    ring = replace(ring, radius_px=ring.radius_px * 13 / um_per_px)
    there = strip_to_frame(ring, np.array(points), um_per_px=um_per_px)
    back = frame_to_strip(ring, there, um_per_px=um_per_px)
    assert np.allclose(back, points, atol=1e-6)


def test_unwrap_puts_each_angle_and_radius_where_the_docstring_says() -> None:
    y, x = np.mgrid[0:1200, 0:1300].astype(np.float64)
    ring = Ring(640.3, 590.8, 428.4, 1.0)
    angle = np.arctan2(y - ring.center_y_px, x - ring.center_x_px) % (2 * np.pi)
    radius = np.hypot(x - ring.center_x_px, y - ring.center_y_px)
    turns = unwrap(
        np.asarray(np.round(20 + 200 * (0.5 + 0.5 * np.cos(angle))), np.uint8), ring, um_per_px=13.0
    )
    columns = (np.arange(STRIP_COLUMNS) + 0.5) * 2 * np.pi / STRIP_COLUMNS
    assert np.abs(turns.mean(axis=0) - (20 + 200 * (0.5 + 0.5 * np.cos(columns)))).max() < 1.0
    depths = unwrap(np.asarray(np.clip(np.round(radius - 340), 0, 255), np.uint8), ring, um_per_px=13.0)
    assert np.abs(depths.mean(axis=1) - (ring.radius_px + 63.5 - np.arange(STRIP_ROWS) - 340)).max() < 0.6


def test_segment_i_covers_its_arc() -> None:
    strip = (
        np.repeat(np.arange(STRIP_COLUMNS) // 128, STRIP_ROWS)
        .reshape(STRIP_COLUMNS, STRIP_ROWS)
        .T.astype(np.uint8)
    )
    crops = segments(strip)
    assert crops.shape == (SEGMENTS, 128, 128)
    assert all((crops[i] == i).all() for i in range(SEGMENTS))
    edge = strip_to_frame(Ring(0, 0, 428, 1), np.array([[128 - 0.5, 63.5]]), um_per_px=13.0)[0]
    assert np.rad2deg(np.arctan2(edge[1], edge[0])) == pytest.approx(SEGMENT_DEG)


def test_a_ring_beyond_the_edge_is_refused() -> None:
    with pytest.raises(LocateError, match="not wholly in view") as caught:
        unwrap(np.zeros((1200, 1200), np.uint8), Ring(480, 600, 428, 1.0), um_per_px=13.0)
    assert caught.value.out_of_view


@given(st.floats(0, 359.9), st.floats(-0.6, 0.6), SCALES)
def test_a_dot_on_the_part_lies_at_the_same_place_of_the_strip_at_any_scale(
    angle_deg: float, out_mm: float, um_per_px: float
) -> None:
    side = round(13_400 / um_per_px)
    y, x = np.mgrid[0:side, 0:side].astype(np.float64)
    ring = Ring(side / 2, side / 2 - 0.3, 5564 / um_per_px, 1.0)
    radius, angle = (5564 + out_mm * 1000) / um_per_px, np.deg2rad(angle_deg)
    away = np.hypot(
        x - ring.center_x_px - radius * np.cos(angle), y - ring.center_y_px - radius * np.sin(angle)
    )
    dot = np.asarray(np.round(250 * np.exp(-0.5 * (away * um_per_px / 90) ** 2)), np.uint8)
    strip = unwrap(dot, ring, um_per_px=um_per_px).astype(np.float64)
    total, turn = strip.sum(), 2 * np.pi / STRIP_COLUMNS
    row = (strip.sum(axis=1) * np.arange(STRIP_ROWS)).sum() / total
    along = np.angle((strip.sum(axis=0) * np.exp(1j * turn * (np.arange(STRIP_COLUMNS) + 0.5))).sum())
    assert row == pytest.approx(63.5 - out_mm * 1000 / 13, abs=0.3)
    assert abs(np.angle(np.exp(1j * (along - angle)))) < 0.3 * turn


def test_a_strip_has_rows_of_13_um_so_a_coarse_image_must_show_more_than_its_ring() -> None:
    ring = Ring(300, 300, 214, 1.0)
    assert in_view(ring, 600, 600, um_per_px=26.0)
    assert not in_view(ring, 2 * 246, 2 * 246, um_per_px=26.0)
    assert unwrap(np.zeros((600, 600), np.uint8), ring, um_per_px=26.0).shape == (STRIP_ROWS, STRIP_COLUMNS)

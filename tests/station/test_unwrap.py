import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_COLUMNS, STRIP_ROWS, Ring
from station.errors import LocateError
from station.vision.unwrap import frame_to_strip, segments, strip_to_frame, unwrap

RINGS = st.builds(Ring, st.floats(600, 3600), st.floats(600, 1500), st.floats(400, 450), st.just(1.0))


@given(
    RINGS,
    st.lists(
        st.tuples(st.floats(-0.49, STRIP_COLUMNS - 0.51), st.floats(0, STRIP_ROWS - 1)),
        min_size=1,
        max_size=20,
    ),
)
def test_strip_to_frame_and_back_is_exact(ring: Ring, points: list[tuple[float, float]]) -> None:
    there = strip_to_frame(ring, np.array(points))
    back = frame_to_strip(ring, there)
    assert np.allclose(back, points, atol=1e-6)


def test_unwrap_puts_each_angle_and_radius_where_the_docstring_says() -> None:
    y, x = np.mgrid[0:1200, 0:1300].astype(np.float64)
    ring = Ring(640.3, 590.8, 428.4, 1.0)
    angle = np.arctan2(y - ring.center_y_px, x - ring.center_x_px) % (2 * np.pi)
    radius = np.hypot(x - ring.center_x_px, y - ring.center_y_px)
    turns = unwrap(np.asarray(np.round(20 + 200 * (0.5 + 0.5 * np.cos(angle))), np.uint8), ring)
    columns = (np.arange(STRIP_COLUMNS) + 0.5) * 2 * np.pi / STRIP_COLUMNS
    assert np.abs(turns.mean(axis=0) - (20 + 200 * (0.5 + 0.5 * np.cos(columns)))).max() < 1.0
    depths = unwrap(np.asarray(np.clip(np.round(radius - 340), 0, 255), np.uint8), ring)
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
    edge = strip_to_frame(Ring(0, 0, 428, 1), np.array([[128 - 0.5, 63.5]]))[0]
    assert np.rad2deg(np.arctan2(edge[1], edge[0])) == pytest.approx(SEGMENT_DEG)


def test_a_ring_beyond_the_edge_is_refused() -> None:
    with pytest.raises(LocateError, match="not wholly in view") as caught:
        unwrap(np.zeros((1200, 1200), np.uint8), Ring(480, 600, 428, 1.0))
    assert caught.value.out_of_view

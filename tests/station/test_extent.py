import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.classify.extent import CELL_PX, CELLS, Map, extents, whole_map
from station.domain import SEGMENTS, STRIP_COLUMNS

COLUMNS = SEGMENTS * CELLS


def box_map(left_px: float, top_px: float, width_px: float, height_px: float) -> Map:
    """Map (32, 672) of a rectangle on the strip, closed along the columns: what each cell is covered of."""

    def covered(low: float, high: float, cells: int) -> np.ndarray:  # type: ignore[type-arg]
        edges = np.arange(cells + 1) * CELL_PX
        return np.clip(np.minimum(edges[1:], high) - np.maximum(edges[:-1], low), 0, CELL_PX) / CELL_PX

    along = covered(left_px, left_px + width_px, COLUMNS) + covered(
        left_px - STRIP_COLUMNS, left_px + width_px - STRIP_COLUMNS, COLUMNS
    )
    return np.asarray(covered(top_px, top_px + height_px, CELLS)[:, None] * along[None, :], np.float32)


@given(st.floats(0, STRIP_COLUMNS - 1), st.floats(8, 90), st.floats(8, 900), st.floats(8, 30))
def test_a_rectangle_is_measured_to_a_fraction_of_a_cell_wherever_it_lies(
    left: float, top: float, width: float, height: float
) -> None:
    (found,) = extents(box_map(left, top, width, height), 0.0)
    assert found.end_px - found.start_px == pytest.approx(width, abs=CELL_PX)
    assert found.bottom_px - found.top_px == pytest.approx(height, abs=CELL_PX)
    assert found.area_px2 == pytest.approx(width * height, rel=1e-3)
    off = (found.start_px + found.end_px) / 2 - (left + width / 2)
    assert abs((off + STRIP_COLUMNS / 2) % STRIP_COLUMNS - STRIP_COLUMNS / 2) < CELL_PX
    assert 0 <= found.start_px < STRIP_COLUMNS


@given(st.integers(0, COLUMNS - 1))
def test_turning_the_map_turns_the_extent_and_nothing_else(turn: int) -> None:
    values = np.maximum(box_map(300, 40, 61, 17), box_map(1500, 60, 9, 9))
    still, turned = extents(values, 0.0), extents(np.roll(values, turn, axis=1), 0.0)
    assert sorted(round(e.area_px2, 2) for e in still) == sorted(round(e.area_px2, 2) for e in turned)
    assert sorted(round(e.end_px - e.start_px, 3) for e in still) == sorted(
        round(e.end_px - e.start_px, 3) for e in turned
    )


def test_an_area_over_the_seam_is_one() -> None:
    (found,) = extents(box_map(STRIP_COLUMNS - 20, 50, 60, 12), 0.0)
    assert found.segments == {SEGMENTS - 1, 0}
    assert found.start_px == pytest.approx(STRIP_COLUMNS - 20, abs=1)
    assert found.end_px > STRIP_COLUMNS


def test_all_round_is_one_area_of_the_whole_circumference() -> None:
    (found,) = extents(box_map(0, 60, STRIP_COLUMNS, 12), 0.0)
    assert (found.start_px, found.end_px) == (0.0, STRIP_COLUMNS)
    assert len(found.segments) == SEGMENTS


def test_near_areas_are_joined_only_where_asked() -> None:
    values = np.maximum(box_map(400, 60, 100, 12), box_map(540, 60, 100, 12))
    assert len(extents(values, 0.0)) == 2
    (found,) = extents(values, 77.0)
    assert found.end_px - found.start_px == pytest.approx(240, abs=2)


def test_nothing_there_gives_nothing() -> None:
    assert extents(np.zeros((CELLS, COLUMNS), np.float32), 0.0) == []


def test_the_whole_map_lays_the_crops_side_by_side() -> None:
    maps = np.zeros((SEGMENTS, 2, CELLS, CELLS), np.float32)
    maps[3, 1, 5, 7] = 1
    assert np.argwhere(whole_map(maps)).tolist() == [[1, 5, 3 * CELLS + 7]]

"""Finds the connected areas in the defect map of a weld and measures them to a fraction of a cell; pure.

The value of a cell is the fraction of it that a defect covers, so sums over cells are areas, and edges can
lie inside cells.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENT_PX

CELL_PX = 4
"""Side of a cell in pixels of the strip."""
CELLS = SEGMENT_PX // CELL_PX
"""Number of cells along the side of a crop."""
LEVEL = 0.35
"""Minimum covered fraction of a cell that belongs to a defect."""

Map = NDArray[np.float32]
"""Defect map: covered fraction of each cell, 0 to 1."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Extent:
    """One connected area, in pixels of the strip; row 0 is outermost."""

    start_px: float
    end_px: float
    """Last column; exceeds the width of the strip if the area crosses its end."""
    top_px: float
    bottom_px: float
    area_px2: float
    segments: frozenset[int]
    """Indices of the segments that the area reaches, 0 to 20."""
    peak: float
    """Highest covered fraction of a cell."""


def whole_map(maps: Map) -> Map:
    """Return the map (C, 32, 672) of the strip from the maps (21, C, 32, 32) of its crops."""
    crops, kinds, rows, columns = maps.shape
    return np.ascontiguousarray(maps.transpose(1, 2, 0, 3).reshape(kinds, rows, crops * columns))


def extents(values: Map, join_px: float) -> list[Extent]:
    """Return the areas in a map (rows, columns) whose last column is next to its first.

    Areas less than `join_px` apart are one area.
    """
    present = values >= LEVEL
    if not present.any():
        return []
    turn = _calmest(np.asarray(present.any(axis=0)))
    rolled, there = np.roll(values, -turn, axis=1), np.roll(present, -turn, axis=1)
    reach = max(3, 2 * round(join_px / CELL_PX / 2) + 1)
    wide = cv2.dilate(there.astype(np.uint8), np.ones((3, reach), np.uint8))
    count, labels = cv2.connectedComponents(wide, connectivity=8)
    return [_measure(rolled, there & (labels == label), turn) for label in range(1, count)]


def _calmest(busy: NDArray[np.bool_]) -> int:
    """Return a column in the middle of the longest stretch without a defect, or 0 if there is none."""
    free = np.flatnonzero(~np.concatenate([busy, busy]))
    if not free.size:
        return 0
    stretches = np.split(free, np.flatnonzero(np.diff(free) > 1) + 1)
    longest = max(stretches, key=len)
    return int(longest[len(longest) // 2]) % busy.size


def _measure(values: Map, chosen: NDArray[np.bool_], turn: int) -> Extent:
    near = cv2.dilate(chosen.astype(np.uint8), np.ones((3, 3), np.uint8)).astype(bool)
    own = np.where(near, values, 0.0)
    columns = np.flatnonzero(chosen.any(axis=0))
    segments = frozenset(int(index) for index in ((columns + turn) % values.shape[1]) // CELLS)
    left, right = _edges(own.max(axis=0), columns)
    top, bottom = _edges(own.max(axis=1), np.flatnonzero(chosen.any(axis=1)))
    start = (left + turn) % values.shape[1] if right - left < values.shape[1] else 0.0
    length = min(right - left, float(values.shape[1]))
    return Extent(
        start_px=start * CELL_PX,
        end_px=(start + length) * CELL_PX,
        top_px=top * CELL_PX,
        bottom_px=bottom * CELL_PX,
        area_px2=float(own.sum()) * CELL_PX**2,
        segments=segments,
        peak=float(values[chosen].max()),
    )


def _edges(profile: NDArray[np.float32], there: NDArray[np.int64]) -> tuple[float, float]:
    """Return where a profile of covered fractions begins and ends, in cells.

    The uncovered fraction of the outermost cells is outside; the covered fraction of their neighbours is
    inside.
    """
    first, last = int(there[0]), int(there[-1])
    before = float(profile[first - 1]) if first > 0 else 0.0
    after = float(profile[last + 1]) if last + 1 < profile.size else 0.0
    if first == last:
        middle, half = first + 0.5 + (after - before) / 2, (float(profile[first]) + before + after) / 2
        return middle - half, middle + half
    return first + 1 - float(profile[first]) - before, last + float(profile[last]) + after

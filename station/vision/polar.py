"""Reads the marks around a rough circle by sector: where the weld's centre line is, if it is there."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from station.vision.marks import PART_PX, Marks
from station.vision.reduced import FINDER_UM_PER_PX, Circle

Array = NDArray[np.float64]
Field = NDArray[np.float32]

SECTORS = 84
"""Number of sectors of the circle: four of each segment."""
SECTOR_RAD = (np.arange(SECTORS) + 0.5) * (2 * np.pi / SECTORS)
"""Angle of the middle of each sector (84,) in radians, clockwise from +x."""
RAYS = 4
"""Number of rays that are averaged in a sector."""
BAND_MM = 1.4
"""Distance from the circle up to which weld is looked for."""
NEAR_MM = 0.7
"""Standard deviation in mm of the preference for weld near the circle."""

_HALF = round(BAND_MM * 1000 / FINDER_UM_PER_PX / PART_PX)
_OFFSETS = np.arange(-_HALF, _HALF + 1, dtype=np.float32) * np.float32(PART_PX)
_PREFERENCE = np.exp(-0.5 * (_OFFSETS * FINDER_UM_PER_PX / 1000 / NEAR_MM) ** 2).astype(np.float32)
_ANGLES = (np.arange(SECTORS * RAYS, dtype=np.float32) + 0.5) * np.float32(2 * np.pi / (SECTORS * RAYS))
_COS, _SIN = np.cos(_ANGLES)[:, None], np.sin(_ANGLES)[:, None]
_PLACES = np.arange(len(_OFFSETS))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Sectors:
    """What the 84 sectors around a circle show."""

    inner: Array
    """Distance (84,) of the inner border of bead, or of bare joint, from the circle in px of the reduced
    picture, positive outwards."""
    outer: Array
    """Distance (84,) of its outer border."""
    presence: Array
    """Highest covered fraction (84,) between the borders, 0 to 1."""
    is_bead: NDArray[np.bool_]
    """Whether they are the borders of a bead (84,), and not of a bare joint."""

    @property
    def middle(self) -> Array:
        """Distance (84,) of the weld's centre line from the circle."""
        return (self.inner + self.outer) / 2


def read_sectors(marks: Marks, circle: Circle) -> Sectors:
    """Return what the sectors around a circle show.

    A border lies where the coverage falls to half of its highest value near the circle.
    """
    reach = circle.radius + (_HALF + 2) * PART_PX
    window = marks.around(circle.x, circle.y, reach)
    radius = np.float32(circle.radius) + _OFFSETS
    map_x = (np.float32(circle.x + 0.5) + radius * _COS) / np.float32(PART_PX) - np.float32(
        window.column + 0.5
    )
    map_y = (np.float32(circle.y + 0.5) + radius * _SIN) / np.float32(PART_PX) - np.float32(window.row + 0.5)
    rays = cv2.remap(
        window.coverage, map_x, map_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0
    )
    profiles = np.asarray(rays).reshape(SECTORS, RAYS, len(_OFFSETS), 2).mean(axis=1)
    bead, joint = _borders(profiles[..., 0]), _borders(profiles[..., 1])
    is_bead = bead[2] >= joint[2]
    inner, outer, presence = (
        np.where(is_bead, *pair).astype(np.float64) for pair in zip(bead, joint, strict=True)
    )
    return Sectors(inner=inner, outer=outer, presence=presence, is_bead=is_bead)


def _borders(profiles: Field) -> tuple[Field, Field, Field]:
    """Return inner and outer border (84,) and the highest value between (84,) of profiles (84, offsets)."""
    top = (profiles * _PREFERENCE).argmax(axis=1)[:, None]
    height = np.take_along_axis(profiles, top, axis=1)
    below = profiles < height / 2
    inner = np.where(below & (_PLACES < top), _PLACES, -1).max(axis=1)
    outer = np.where(below & (_PLACES > top), _PLACES, len(_PLACES)).min(axis=1)
    relative = profiles / (height + 1e-6)
    return (
        (_crossing(relative, inner, 1) - _HALF) * PART_PX,
        (_crossing(relative, outer, -1) - _HALF) * PART_PX,
        height[:, 0],
    )


def _crossing(relative: Field, at: NDArray[np.int64], step: int) -> Field:
    """Return where profiles cross one half between the places `at`, below it, and `at` + `step`, above it."""
    lines, last = np.arange(len(relative)), len(_PLACES) - 1
    low, high = relative[lines, np.clip(at, 0, last)], relative[lines, np.clip(at + step, 0, last)]
    part = np.clip((0.5 - low) / np.maximum(high - low, 1e-6), 0, 1)
    return np.asarray(at + step * part, np.float32)

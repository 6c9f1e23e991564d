"""Unwraps the ring into the strip, and converts points between both; the same for training, replay and line.

The strip is (128, 2688) uint8. Row 0 is outermost, and a row is 13 µm high whatever the scale of the frame,
because the networks judge at that scale. Column 0 begins at angle 0 (+x), and columns run clockwise as seen
in the image. With column c and row r (pixel centres):

    angle  = (c + 0.5) * 360 / 2688                              degrees
    radius = ring.radius_px + (63.5 - r) * 13 / um_per_px        frame pixels
    x = center_x + radius * cos(angle),  y = center_y + radius * sin(angle)
"""

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import (
    NETWORK_UM_PER_PX,
    SEGMENT_PX,
    SEGMENTS,
    STRIP_COLUMNS,
    STRIP_ROWS,
    Image,
    Ring,
)
from station.errors import LocateError

Points = NDArray[np.float64]
"""K points (K, 2)."""

RAD_PER_COLUMN = 2 * np.pi / STRIP_COLUMNS
"""Angle of one column in radians."""
MIDDLE_ROW = (STRIP_ROWS - 1) / 2
"""Row of the ring."""


def row_px(um_per_px: float) -> float:
    """Return the height of a row of the strip in pixels of a frame of this scale; exactly 1 at 13 µm/px."""
    return NETWORK_UM_PER_PX / um_per_px


def strip_to_frame(ring: Ring, points: Points, *, um_per_px: float) -> Points:
    """Return the frame points (K, 2) as (x, y) of strip points (K, 2) as (column, row)."""
    angle = (points[:, 0] + 0.5) * RAD_PER_COLUMN
    step = row_px(um_per_px)
    radius = ring.radius_px + MIDDLE_ROW * step - points[:, 1] * step
    return np.stack(
        [ring.center_x_px + radius * np.cos(angle), ring.center_y_px + radius * np.sin(angle)], axis=1
    )


def frame_to_strip(ring: Ring, points: Points, *, um_per_px: float) -> Points:
    """Return the strip points (K, 2) as (column, row) of frame points (K, 2) as (x, y).

    Columns lie in [-0.5, 2687.5).
    """
    dx, dy = points[:, 0] - ring.center_x_px, points[:, 1] - ring.center_y_px
    angle = np.arctan2(dy, dx) % (2 * np.pi)
    step = row_px(um_per_px)
    row = (ring.radius_px + MIDDLE_ROW * step - np.hypot(dx, dy)) / step
    return np.stack([angle / RAD_PER_COLUMN - 0.5, row], axis=1)


def reach_px(radius_px: float, *, um_per_px: float) -> float:
    """Return the outer radius of the strip of a ring of this radius, in pixels of a frame of this scale."""
    return radius_px + STRIP_ROWS / 2 * row_px(um_per_px)


def in_view(ring: Ring, width_px: int, height_px: int, *, um_per_px: float) -> bool:
    """Return whether the whole strip lies inside an image of this size and scale."""
    reach = reach_px(ring.radius_px, um_per_px=um_per_px)
    return (
        reach <= ring.center_x_px <= width_px - 1 - reach
        and reach <= ring.center_y_px <= height_px - 1 - reach
    )


def unwrap(image: Image, ring: Ring, *, um_per_px: float) -> Image:
    """Return the strip (128, 2688) uint8 of a ring in `image` (height, width), by cubic interpolation.

    `um_per_px` is the scale of the image, `ring` is in its pixels. A finer image is not smoothed first: at
    9 µm/px that changes no score by more than the noise does, and takes away a fifth of the sharpness.

    Raises LocateError if the strip is not wholly inside the image.
    """
    height, width = image.shape
    if not in_view(ring, width, height, um_per_px=um_per_px):
        raise LocateError(
            f"the ring at ({ring.center_x_px:.0f}, {ring.center_y_px:.0f}) px is not wholly in view",
            out_of_view=True,
        )
    angle = (np.arange(STRIP_COLUMNS, dtype=np.float32) + 0.5) * np.float32(RAD_PER_COLUMN)
    step = row_px(um_per_px)
    rows = np.float32(step) * np.arange(STRIP_ROWS, dtype=np.float32)
    radius = np.float32(ring.radius_px + MIDDLE_ROW * step) - rows
    x = np.float32(ring.center_x_px) + radius[:, None] * np.cos(angle)
    y = np.float32(ring.center_y_px) + radius[:, None] * np.sin(angle)
    return np.asarray(cv2.remap(image, x, y, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE), np.uint8)


def segments(strip: Image) -> Image:
    """Return the crops (21, 128, 128) uint8 of a strip; crop i covers [i, i + 1) * 360 / 21 degrees."""
    return np.ascontiguousarray(strip.reshape(STRIP_ROWS, SEGMENTS, SEGMENT_PX).transpose(1, 0, 2))

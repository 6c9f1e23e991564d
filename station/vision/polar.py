"""Unwraps a wide band around a rough circle, the input of the ring network."""

import cv2
import numpy as np

from station.domain import STRIP_COLUMNS, Image

ROWS = 192
"""Height of the band."""
COLUMNS = 672
"""Width of the band."""
SECTORS = 84
"""Number of sectors for which the ring network gives an offset."""


def polar_band(image: Image, x_px: float, y_px: float, radius_px: float) -> Image:
    """Return the band (192, 672) uint8 around a circle.

    Row r lies at radius `radius_px` + r - 95.5; columns run clockwise from angle 0 and are 4 px wide.
    """
    angle = (np.arange(STRIP_COLUMNS, dtype=np.float32) + 0.5) * np.float32(2 * np.pi / STRIP_COLUMNS)
    radius = np.float32(radius_px - (ROWS - 1) / 2) + np.arange(ROWS, dtype=np.float32)
    map_x = np.float32(x_px) + radius[:, None] * np.cos(angle)
    map_y = np.float32(y_px) + radius[:, None] * np.sin(angle)
    fine = cv2.remap(image, map_x, map_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    return np.asarray(cv2.resize(fine, (COLUMNS, ROWS), interpolation=cv2.INTER_AREA), np.uint8)

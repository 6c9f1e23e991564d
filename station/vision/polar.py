"""The picture that the ring network sees: a wide band round a rough circle, flattened."""

import cv2
import numpy as np

from station.domain import STRIP_COLUMNS, Image

ROWS = 192
COLUMNS = 672
SECTORS = 84


def polar_band(image: Image, x_px: float, y_px: float, radius_px: float) -> Image:
    """Band (192, 672) uint8: row r lies at radius `radius_px` + r - 95.5, columns run clockwise from angle 0, 4 px each."""
    angle = (np.arange(STRIP_COLUMNS, dtype=np.float32) + 0.5) * np.float32(2 * np.pi / STRIP_COLUMNS)
    radius = np.float32(radius_px - (ROWS - 1) / 2) + np.arange(ROWS, dtype=np.float32)
    map_x = np.float32(x_px) + radius[:, None] * np.cos(angle)
    map_y = np.float32(y_px) + radius[:, None] * np.sin(angle)
    fine = cv2.remap(image, map_x, map_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=0)
    return np.asarray(cv2.resize(fine, (COLUMNS, ROWS), interpolation=cv2.INTER_AREA), np.uint8)

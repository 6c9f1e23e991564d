"""Brings images to the scale at which the ring is looked for, and rings back to the pixels of the image."""

from dataclasses import replace

import cv2
import numpy as np

from station.domain import NETWORK_UM_PER_PX, Image, Ring


def to_network_scale(image: Image, *, um_per_px: float) -> Image:
    """Return `image` (height, width) uint8 of this scale at 13 µm/px."""
    if um_per_px == NETWORK_UM_PER_PX:
        return image
    factor = um_per_px / NETWORK_UM_PER_PX
    method = cv2.INTER_AREA if factor < 1 else cv2.INTER_LINEAR
    return np.asarray(cv2.resize(image, None, fx=factor, fy=factor, interpolation=method), np.uint8)


def from_network_scale(ring: Ring, *, um_per_px: float) -> Ring:
    """Return a ring found in the image of `to_network_scale` in pixels of the original image."""
    if um_per_px == NETWORK_UM_PER_PX:
        return ring
    factor = um_per_px / NETWORK_UM_PER_PX
    # resizing keeps the borders of the image in place, not the centres of its pixels
    x, y = ((center + 0.5) / factor - 0.5 for center in (ring.center_x_px, ring.center_y_px))
    return replace(
        ring,
        center_x_px=x,
        center_y_px=y,
        radius_px=ring.radius_px / factor,
        residual_px=ring.residual_px / factor,
    )

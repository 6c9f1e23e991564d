"""Makes the small images of an inspection for the window."""

import cv2

from station.channel.events import Preview
from station.domain import STRIP_ROWS, Image, Ring
from station.vision.unwrap import unwrap

MARGIN_PX = 75
"""Margin around the weld, in frame pixels."""
SCALE = 0.75
"""Scale of the image of the ring."""
FRAME_SCALE = 0.25
"""Scale of the whole frame if no ring was found."""


def make_preview(inspection_id: int, image: Image, ring: Ring | None) -> Preview:
    """Return the image around the ring and the strip; without a ring, the whole frame at a smaller scale."""
    height, width = image.shape
    if ring is None:
        return Preview(
            inspection_id=inspection_id,
            scale=FRAME_SCALE,
            origin_px=(0, 0),
            frame_jpeg=_jpeg(image, FRAME_SCALE),
            strip_jpeg=b"",
        )
    reach = ring.radius_px + STRIP_ROWS / 2 + MARGIN_PX
    left, top = max(0, int(ring.center_x_px - reach)), max(0, int(ring.center_y_px - reach))
    right, bottom = min(width, int(ring.center_x_px + reach)), min(height, int(ring.center_y_px + reach))
    return Preview(
        inspection_id=inspection_id,
        scale=SCALE,
        origin_px=(left, top),
        frame_jpeg=_jpeg(image[top:bottom, left:right], SCALE),
        strip_jpeg=_jpeg(unwrap(image, ring), 1.0),
    )


def _jpeg(image: Image, scale: float) -> bytes:
    small = (
        image if scale == 1.0 else cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    )
    return bytes(cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 85])[1])

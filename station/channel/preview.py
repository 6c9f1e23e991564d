"""Makes the small images of an inspection for the window."""

import cv2

from station.channel.events import Preview
from station.domain import Image, Ring
from station.vision.unwrap import reach_px, row_px, unwrap

MARGIN_ROWS = 75
"""Margin around the strip, in rows of the strip."""
SCALE = 0.75
"""Scale of the image of the ring at 13 µm/px; at another scale its size on the part is kept."""
FRAME_SCALE = 0.25
"""Scale of the whole frame if no ring was found."""


def make_preview(inspection_id: int, image: Image, ring: Ring | None, *, um_per_px: float) -> Preview:
    """Return the image around the ring and the strip; without a ring, the whole frame at a smaller scale.

    `um_per_px` is the scale of `image` (height, width) uint8. Raises LocateError if the ring is cut off.
    """
    height, width = image.shape
    if ring is None:
        return Preview(
            inspection_id=inspection_id,
            scale=FRAME_SCALE,
            origin_px=(0, 0),
            frame_jpeg=_jpeg(image, FRAME_SCALE),
            strip_jpeg=b"",
            um_per_px=um_per_px,
        )
    scale = min(1.0, SCALE / row_px(um_per_px))
    reach = reach_px(ring.radius_px, um_per_px=um_per_px) + MARGIN_ROWS * row_px(um_per_px)
    left, top = max(0, int(ring.center_x_px - reach)), max(0, int(ring.center_y_px - reach))
    right, bottom = min(width, int(ring.center_x_px + reach)), min(height, int(ring.center_y_px + reach))
    return Preview(
        inspection_id=inspection_id,
        scale=scale,
        origin_px=(left, top),
        frame_jpeg=_jpeg(image[top:bottom, left:right], scale),
        strip_jpeg=_jpeg(unwrap(image, ring, um_per_px=um_per_px), 1.0),
        um_per_px=um_per_px,
    )


def _jpeg(image: Image, scale: float) -> bytes:
    small = (
        image if scale == 1.0 else cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    )
    return bytes(cv2.imencode(".jpg", small, [cv2.IMWRITE_JPEG_QUALITY, 85])[1])

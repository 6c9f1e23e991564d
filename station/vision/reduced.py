"""Brings a frame to the scale at which the weld is looked for, and takes circles back to the frame."""

from dataclasses import dataclass

import cv2
import numpy as np

from station.domain import Image

FINDER_UM_PER_PX = 52.0
"""Scale of the picture in which the weld is looked for: coarse, so quick, but a joint still shows."""


@dataclass(frozen=True, slots=True)
class Circle:
    """Circle on the object: centre (x, y) and radius in px of the reduced picture."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True, slots=True, eq=False)
class Reduced:
    """A frame at 52 µm/px."""

    image: Image
    """Picture (height, width) uint8."""
    frame_px_x: float
    """Width of one of its pixels in px of the frame."""
    frame_px_y: float
    """Height of one of its pixels in px of the frame."""

    def in_frame(self, circle: Circle) -> Circle:
        """Return a circle of this picture in px of the frame."""
        mean_px = (self.frame_px_x * self.frame_px_y) ** 0.5
        return Circle(
            (circle.x + 0.5) * self.frame_px_x - 0.5,
            (circle.y + 0.5) * self.frame_px_y - 0.5,
            circle.radius * mean_px,
        )


def reduce_to_finder(image: Image, um_per_px: float) -> Reduced:
    """Return `image` (height, width) uint8, whose scale is `um_per_px`, at 52 µm/px.

    A finer image is averaged over the area of each pixel, a coarser one is interpolated. A few columns and
    rows at the far borders that fill no pixel are left out.
    """
    factor = FINDER_UM_PER_PX / um_per_px
    height, width = image.shape
    if factor == round(factor):
        whole = round(factor)  # whole pixels are averaged ten times as fast as fractions of them
        image = image[: max(1, height // whole) * whole, : max(1, width // whole) * whole]
        height, width = image.shape
    size = max(1, round(width / factor)), max(1, round(height / factor))
    way = cv2.INTER_AREA if factor > 1 else cv2.INTER_LINEAR
    small = np.asarray(cv2.resize(image, size, interpolation=way), np.uint8)
    return Reduced(small, frame_px_x=width / size[0], frame_px_y=height / size[1])

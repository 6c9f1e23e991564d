"""The station's optics as data: camera and lens, and the camera equation (paper, section 3.1 and eq. 5).

World: x right, y up, z to the camera, mm, origin where the optical axis meets the object plane.
Pixels: (x, y), centre of the top left pixel at (0, 0), y down.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Optics:
    """Basler a2A4200-12gm, 35 mm lens at 216 mm: 13 um per pixel on the object."""

    width_px: int = 4200
    height_px: int = 2160
    distance_mm: float = 216.0
    pixel_mm: float = 0.013

    @property
    def um_per_px(self) -> float:
        """Scale of the images in µm per pixel, in the object plane."""
        return self.pixel_mm * 1000

    @property
    def focal_px(self) -> float:
        """Focal length in pixels."""
        return self.distance_mm / self.pixel_mm

    def project(self, points_mm: Array) -> Array:
        """Project world points (K, 3) to pixels (K, 2) as (x, y): eq. (5), the camera on the z axis."""
        depth = self.distance_mm - points_mm[:, 2]
        x = self.width_px / 2 - 0.5 + self.focal_px * points_mm[:, 0] / depth
        y = self.height_px / 2 - 0.5 - self.focal_px * points_mm[:, 1] / depth
        return np.stack([x, y], axis=1)

"""Where points of a part appear in the frame, by the camera equation (paper, eq. 5)."""

import numpy as np
from numpy.typing import NDArray
from skimage.measure import CircleModel

from synth.camera.optics import Optics
from synth.part.part import Part

Array = NDArray[np.float64]


def project(part: Part, optics: Optics, angle_rad: Array, radius_mm: Array) -> Array:
    """Project points of the weld, taken at the outer partner's height, to frame pixels (K, 2) as (x, y)."""
    return optics.project(part.pose.to_world(part.geometry.embed(angle_rad, radius_mm, np.array(0.0))))


def ring_px(part: Part, optics: Optics) -> tuple[float, float, float]:
    """Return centre x, centre y and radius in frame pixels of the circle along the projected centre."""
    angle = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    points = project(part, optics, angle, np.full_like(angle, part.bead.radius_mm))
    circle = CircleModel.from_estimate(points)  # type: ignore[no-untyped-call]
    x, y = circle.center
    return float(x), float(y), float(circle.radius)

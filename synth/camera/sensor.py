"""Radiance to grey levels: lens blur, veiling glare, vignetting, exposure, noise, clipping, 8 bit."""

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.camera.optics import Optics
from synth.part.part import Part
from synth.part.streams import Stream, stream

FULL_WELL_E = 10_000.0
"""Electrons at grey level 255."""
VEIL_RADIANCE = 8.0
"""Radiance of a clean partner: the source of the veil."""
NOMINAL_GAIN = 17.0
"""Grey levels per unit of radiance at exposure 1."""


def expose(
    radiance: NDArray[np.float32], part: Part, optics: Optics, origin_px: tuple[int, int] = (0, 0)
) -> NDArray[np.uint8]:
    """Return grey levels (H, W) uint8 of a window of radiance (H, W) at `origin_px` (x, y) of the frame."""
    rng = stream(part.seed, Stream.SENSOR_NOISE)
    sensor = part.sensor
    image = cv2.GaussianBlur(radiance, (0, 0), sensor.defocus_px)
    if sensor.veil > 0:
        image = (1 - sensor.veil) * image + sensor.veil * VEIL_RADIANCE
    height, width = image.shape
    x = (np.arange(width) + origin_px[0] - optics.width_px / 2) / optics.focal_px
    y = (np.arange(height) + origin_px[1] - optics.height_px / 2) / optics.focal_px
    cos4 = (1.0 / (1.0 + x[None, :] ** 2 + y[:, None] ** 2) ** 2).astype(np.float32)
    level = np.clip(image * cos4 * (NOMINAL_GAIN * sensor.exposure), 0, 4 * 255)
    noise_dn = np.sqrt(level * (255.0 / FULL_WELL_E) + sensor.read_noise_dn**2, dtype=np.float32)
    level += noise_dn * rng.standard_normal(level.shape, dtype=np.float32)
    return np.asarray(np.clip(np.rint(level), 0, 255), np.uint8)

"""Image quality gate: exposure and sharpness, measured on the strip so that the surroundings do not count."""

import cv2
import numpy as np

from station.defects import Reason
from station.domain import Image, Quality
from station.settings.quality import QualitySettings

DARK_DN = 2
"""Maximum grey level of a dark pixel."""
SATURATED_DN = 254
"""Minimum grey level of a saturated pixel."""


def measure(strip: Image) -> Quality:
    """Return the image quality of a strip (128, 2688) uint8."""
    mean_dn = float(strip.mean())
    laplacian = cv2.Laplacian(strip, cv2.CV_32F)
    return Quality(
        mean_dn=mean_dn,
        dark_share=float(np.mean(strip <= DARK_DN)),
        saturated_share=float(np.mean(strip >= SATURATED_DN)),
        sharpness=float(np.sqrt(np.mean(laplacian**2)) / max(mean_dn, 1.0)),
    )


def gate(quality: Quality, limits: QualitySettings) -> tuple[Reason, str] | None:
    """Return the first reason why the image must not be judged, with the numbers as text, or None."""
    if quality.mean_dn < limits.min_mean_dn:
        return Reason.TOO_DARK, f"mean grey level {quality.mean_dn:.1f}, limit {limits.min_mean_dn:g}"
    for reason, share, limit, level in (
        (Reason.TOO_DARK, quality.dark_share, limits.max_dark_share, f"{DARK_DN} or below"),
        (Reason.TOO_BRIGHT, quality.saturated_share, limits.max_saturated_share, f"{SATURATED_DN} or above"),
    ):
        if share > limit:
            return reason, f"{share:.0%} of the strip at grey level {level}, limit {limit:.0%}"
    if quality.sharpness < limits.min_sharpness:
        return Reason.BLURRED, f"sharpness {quality.sharpness:.4f}, limit {limits.min_sharpness:g}"
    return None

"""The section quality of station.toml: limits from which an image or a segment counts as seen."""

from typing import Annotated

from pydantic import Field

from station.settings.section import Section

Fraction = Annotated[float, Field(ge=0.0, le=1.0)]
"""Number from 0 to 1."""


class QualitySettings(Section):
    """Limits of the image quality: of the whole strip, and of each segment."""

    min_mean_dn: float = Field(default=12.0, ge=0, le=255)
    max_dark_share: Fraction = 0.6
    max_saturated_share: Fraction = 0.35
    min_sharpness: float = Field(default=0.01, ge=0)
    min_segment_mean_dn: float = Field(default=15.0, ge=0, le=255)
    """Minimum mean grey level of a segment that was seen."""
    max_segment_dark_fraction: Fraction = 0.5
    """Maximum fraction of a segment at grey level 2 or below."""
    max_segment_saturated_fraction: Fraction = 0.5
    """Maximum fraction of a segment at grey level 254 or above."""
    min_segment_contrast: float = Field(default=0.03, ge=0)
    """Minimum standard deviation of the grey level, divided by its mean."""
    min_segment_sharpness: float = Field(default=0.02, ge=0)
    """Minimum root mean square of the Laplacian, divided by the mean grey level."""
    min_segment_fine_structure: float = Field(default=0.35, ge=0)
    """Minimum fine structure in its weakest direction, relative to the median segment of the part: what is
    out of focus or smeared has less."""
    min_segment_weld: Fraction = 0.0
    """Minimum fraction of a segment in which weld or joint lies on the ring."""
    min_segment_visible: Fraction = 0.4
    """Minimum fraction of a segment that nothing covers; used only with a network that tells it."""

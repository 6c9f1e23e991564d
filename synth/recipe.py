"""What may vary from part to part, and by how much. Plain data; lengths in mm, angles in degrees."""

from dataclasses import dataclass

Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Recipe:
    """Ranges from which one part is drawn, uniformly unless said otherwise."""

    radius_mm: Range = (5.50, 5.63)
    """Radius of the weld's centre line."""
    shift_mm: float = 3.0
    """Largest off-centre shift of the part, along x and along y."""
    tilt_deg: float = 0.6
    """Largest tilt of the part about x and about y."""
    half_width_mm: Range = (0.39, 0.54)
    """Half the width of the bead."""
    crown_mm: Range = (0.015, 0.06)
    """Height of the bead's crown above the partners."""
    ripple_pitch_mm: Range = (0.10, 0.30)
    """Distance between two solidification ripples along the weld."""
    ripple_slope: Range = (0.06, 0.36)
    """Steepness of the ripples: root mean square of dz/ds."""
    crescent_mm: Range = (0.15, 0.60)
    """How far the ripple's middle runs ahead of its ends (paper, Fig. 4b: Gaussian row shift)."""
    rough_slope: Range = (0.02, 0.11)
    """Steepness of the irregular relief that stands for the weld's discontinuities."""
    wobble_mm: Range = (0.0, 0.025)
    """Amplitude of the random border contour."""
    step_mm: float = 0.03
    """Largest height difference between inner and outer partner, either way."""
    gap_mm: Range = (0.05, 0.12)
    """Width of the joint where the weld is missing."""
    hole_length_mm: Range = (0.10, 2.4)
    """Length of a hole along the weld, drawn log-uniformly."""
    holes: tuple[int, int] = (1, 3)
    """Number of holes of a part with holes, both ends included."""
    missing_deg: Range = (12.0, 110.0)
    """Arc of a missing weld."""
    missing_all_share: float = 0.12
    """Share of the parts with a missing weld that have no weld at all."""
    exposure: Range = (0.6, 1.5)
    """Exposure relative to the nominal one."""
    defocus_px: Range = (0.3, 1.3)
    """Standard deviation of the Gaussian blur of the lens."""
    read_noise_dn: Range = (0.4, 1.5)
    """Read noise in grey levels."""


TRAINING = Recipe(holes=(4, 9), hole_length_mm=(0.08, 2.4), missing_deg=(10.0, 150.0))
"""Many defects per part: more defective crops for each rendering."""

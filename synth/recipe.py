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
    sparsity: Range = (0.0, 0.0)
    """How far the ripples are gathered into few deep ones with calm weld between, 0 to 1."""
    chevron: Range = (0.0, 0.0)
    """Form of the ripples, from a round crescent (0) to a sharp arrow (1)."""
    undercut_mm: Range = (0.0, 0.0)
    """Depth of the groove along the bead's borders."""
    bead_scratches: tuple[int, int] = (0, 0)
    """Number of scratches across the bead."""
    bead_reflectance: Range = (0.86, 0.86)
    partner_reflectance: Range = (0.72, 0.72)
    alpha_weld: Range = (0.18, 0.18)
    """Roughness of the weld (paper, section 4.1)."""
    alpha_partner: Range = (0.20, 0.20)
    floor_reflectance: Range = (0.03, 0.03)
    """Of what lies below holes and joint."""
    light_scale: Range = (1.0, 1.0)
    """Size of the light's rings against the nominal ones."""
    light_lean: Range = (0.0, 0.0)
    """How much brighter the light is on one side, 0 to 1."""
    exposure: Range = (0.6, 1.5)
    """Exposure relative to the nominal one."""
    defocus_px: Range = (0.3, 1.3)
    """Standard deviation of the Gaussian blur of the lens."""
    read_noise_dn: Range = (0.4, 1.5)
    """Read noise in grey levels."""


DENSE = Recipe(holes=(4, 9), hole_length_mm=(0.08, 2.4), missing_deg=(10.0, 150.0))
"""The line's surfaces with many defects per part: more defective crops for each rendering."""

WIDE = Recipe(
    half_width_mm=(0.36, 0.57),
    crown_mm=(0.01, 0.08),
    ripple_pitch_mm=(0.08, 0.38),
    ripple_slope=(0.015, 0.36),
    rough_slope=(0.01, 0.11),
    wobble_mm=(0.0, 0.035),
    gap_mm=(0.05, 0.20),
    holes=(4, 9),
    hole_length_mm=(0.08, 2.4),
    missing_deg=(10.0, 150.0),
    sparsity=(0.0, 0.95),
    chevron=(0.0, 1.0),
    undercut_mm=(0.0, 0.03),
    bead_scratches=(0, 4),
    bead_reflectance=(0.55, 0.95),
    partner_reflectance=(0.50, 0.90),
    alpha_weld=(0.10, 0.28),
    alpha_partner=(0.12, 0.30),
    floor_reflectance=(0.01, 0.08),
    light_scale=(0.7, 1.3),
    light_lean=(0.0, 0.7),
    exposure=(0.5, 2.2),
    defocus_px=(0.3, 1.9),
)
"""As dense, with surfaces and lights wider than any one line's: a network that saw one look only is lost on the next."""

"""What may vary from part to part, and by how much. Plain data; lengths in mm, angles in degrees.

A recipe file is TOML: `base` names one of the recipes below, every other key is a field of `Recipe` and takes its place.
"""

import tomllib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, TypeAdapter, ValidationError

from synth.errors import SynthError

Range = tuple[float, float]
Count = tuple[int, int]


def _within(low: float, high: float) -> AfterValidator:
    def check(value: Any) -> Any:
        ends = value if isinstance(value, tuple) else (value, value)
        if not (low <= ends[0] <= ends[1] <= high):
            raise ValueError(f"{list(ends) if isinstance(value, tuple) else value} is not allowed; {low:g} to {high:g}, the smaller first")
        return value

    return AfterValidator(check)


Share = Annotated[float, _within(0, 1)]
Shares = Annotated[Range, _within(0, 1)]
Few = Annotated[Count, _within(0, 200)]


@dataclass(frozen=True, slots=True)
class Recipe:
    """Ranges from which one part is drawn, uniformly unless said otherwise. The defaults are the line's."""

    __pydantic_config__ = ConfigDict(extra="forbid")

    material: Literal["steel", "aluminium", "copper", "nickel-plated"] = "aluminium"
    radius_mm: Annotated[Range, _within(4.0, 7.0)] = (5.50, 5.63)
    """Radius of the weld's centre line."""
    shift_mm: Annotated[float, _within(0, 5)] = 3.0
    """Largest off-centre shift of the part, along x and along y."""
    tilt_deg: Annotated[float, _within(0, 5)] = 0.6
    """Largest tilt of the part about x and about y."""
    half_width_mm: Annotated[Range, _within(0.2, 0.7)] = (0.39, 0.54)
    """Half the width of the bead."""
    bead_offset_mm: Annotated[Range, _within(-0.3, 0.3)] = (-0.04, 0.04)
    """How far the bead's centre line runs outside the joint's."""
    crown_mm: Annotated[Range, _within(0, 0.2)] = (0.015, 0.06)
    """Height of the bead's crown above the partners."""
    spectral_share: Share = 0.3
    """Share of the parts whose relief comes from the measurement's spectrum (paper, eq. 2); the others' ripples are drawn directly."""
    height_scale: Annotated[Range, _within(0, 10)] = (0.7, 2.0)
    """Factor of the spectral relief."""
    shift_scale: Annotated[Range, _within(0, 5)] = (0.5, 2.0)
    """Factor of the row shift that was fitted to the measurement (paper, Fig. 4b)."""
    ripple_pitch_mm: Annotated[Range, _within(0.04, 1)] = (0.10, 0.30)
    """Distance between two solidification ripples along the weld."""
    ripple_slope: Annotated[Range, _within(0, 1)] = (0.06, 0.36)
    """Steepness of the ripples: root mean square of dz/ds."""
    crescent_mm: Annotated[Range, _within(0, 2)] = (0.15, 0.60)
    """How far the ripple's middle runs ahead of its ends."""
    sparsity: Shares = (0.0, 0.4)
    """How far the ripples are gathered into few deep ones with calm weld between."""
    chevron: Shares = (0.0, 0.4)
    """Form of the ripples, from a round crescent (0) to a sharp arrow (1)."""
    rough_slope: Annotated[Range, _within(0, 1)] = (0.02, 0.11)
    """Steepness of the Perlin noise that stands for the weld's discontinuities."""
    wobble_mm: Annotated[Range, _within(0, 0.2)] = (0.0, 0.025)
    """Amplitude of the random border contour."""
    undercut_mm: Annotated[Range, _within(0, 0.2)] = (0.0, 0.01)
    """Depth of the groove along the bead's borders."""
    step_mm: Annotated[float, _within(0, 0.3)] = 0.03
    """Largest height difference between inner and outer partner, either way."""
    gap_mm: Annotated[Range, _within(0.01, 0.5)] = (0.05, 0.16)
    """Width of the joint where the weld is missing."""
    joint_wave_mm: Annotated[Range, _within(0, 0.2)] = (0.004, 0.02)
    """Standard deviation of the joint's line (paper, eq. 4)."""
    holes: Few = (1, 3)
    """Number of holes of a part with holes, both ends included."""
    hole_length_mm: Annotated[Range, _within(0.04, 6)] = (0.09, 2.4)
    """Length of a hole along the weld, drawn log-uniformly."""
    missing_deg: Annotated[Range, _within(1, 359)] = (12.0, 110.0)
    """Arc of a missing weld."""
    missing_all_share: Share = 0.12
    """Share of the parts with a missing weld that have no weld at all."""
    soot: Shares = (0.0, 0.6)
    """Amount of soot, on the weld and at its edges."""
    overlap_mm: Annotated[Range, _within(0, 10)] = (0.5, 3.0)
    """How far the weld's end runs over its start."""
    overlap_width: Annotated[Range, _within(-0.3, 0.5)] = (0.0, 0.08)
    """How much wider the bead is there."""
    overlap_height_mm: Annotated[Range, _within(0, 0.2)] = (0.0, 0.02)
    """How much higher the bead is there."""
    crater_mm: Annotated[Range, _within(0, 0.3)] = (0.005, 0.05)
    """Depth of the crater at the weld's end."""
    spatter: Few = (0, 4)
    """Droplets of melt on bead and partners."""
    bead_scratches: Few = (0, 2)
    scratches: Few = (0, 13)
    """Scratches on the partners."""
    dust: Few = (0, 40)
    """Specks on the partners."""
    fibres: Few = (0, 1)
    """Thin fibres lying across the part."""
    heat_tint: Shares = (0.0, 0.35)
    """How much the partners are tinted beside the weld."""
    circles: bool = True
    """Bores, grooves and steps on the part that are no welds."""
    bead_reflectance: Shares = (0.80, 0.92)
    partner_reflectance: Shares = (0.65, 0.80)
    alpha_weld: Annotated[Range, _within(0.01, 1)] = (0.18, 0.18)
    """Roughness of the weld (paper, section 4.1)."""
    alpha_partner: Annotated[Range, _within(0.01, 1)] = (0.20, 0.20)
    floor_reflectance: Shares = (0.03, 0.03)
    """Of what lies below holes and joint."""
    floor_texture: Shares = (0.0, 0.5)
    """How uneven it is."""
    hole_rim_mm: Annotated[Range, _within(-0.1, 0.2)] = (0.01, 0.05)
    """How far the melt sinks towards a hole's edge; below 0 it is heaped up to a lip."""
    hole_rim_width_mm: Annotated[Range, _within(0.01, 0.3)] = (0.02, 0.06)
    """How far from the edge that is felt."""
    hole_crest_mm: Annotated[Range, _within(0.0, 0.2)] = (0.0, 0.02)
    """How far from the edge it is most."""
    soot_softness: Shares = (0.0, 0.6)
    """From soot patches with sharp edges (0) to clouds (1)."""
    light_scale: Annotated[Range, _within(0.3, 2)] = (1.0, 1.0)
    """Size of the light's rings against the nominal ones."""
    light_lean: Shares = (0.0, 0.1)
    """How much brighter the light is on one side."""
    second_light_share: Share = 0.0
    """Share of the parts seen under a second, low ring light as well."""
    second_light: Annotated[Range, _within(0, 10)] = (0.3, 2.0)
    """Its strength against the first."""
    veil: Shares = (0.0, 0.02)
    """Veiling glare: share of the mean radiance that lies over the whole picture."""
    exposure: Annotated[Range, _within(0.05, 20)] = (0.6, 1.5)
    """Exposure relative to the nominal one, drawn log-uniformly."""
    defocus_px: Annotated[Range, _within(0.1, 5)] = (0.3, 1.3)
    """Standard deviation of the Gaussian blur of the lens."""
    read_noise_dn: Annotated[Range, _within(0, 20)] = (0.4, 1.5)
    """Read noise in grey levels."""


LINE = Recipe()

DENSE = replace(LINE, holes=(4, 9), hole_length_mm=(0.08, 2.4), missing_deg=(10.0, 150.0))
"""The line's surfaces with many defects per part: more defective crops for each rendering."""

WIDE = replace(
    DENSE,
    half_width_mm=(0.30, 0.58),
    bead_offset_mm=(-0.12, 0.12),
    crown_mm=(0.005, 0.08),
    height_scale=(0.3, 3.0),
    shift_scale=(0.0, 3.0),
    ripple_pitch_mm=(0.08, 0.38),
    ripple_slope=(0.015, 0.36),
    sparsity=(0.0, 0.95),
    chevron=(0.0, 1.0),
    rough_slope=(0.01, 0.11),
    wobble_mm=(0.0, 0.04),
    undercut_mm=(0.0, 0.04),
    step_mm=0.22,
    gap_mm=(0.05, 0.22),
    soot=(0.0, 1.0),
    overlap_mm=(0.3, 6.0),
    overlap_width=(-0.05, 0.15),
    overlap_height_mm=(0.0, 0.04),
    crater_mm=(0.005, 0.10),
    spatter=(0, 60),
    bead_scratches=(0, 4),
    fibres=(0, 3),
    heat_tint=(0.0, 0.8),
    bead_reflectance=(0.55, 0.95),
    partner_reflectance=(0.50, 0.90),
    alpha_weld=(0.10, 0.28),
    alpha_partner=(0.12, 0.30),
    floor_reflectance=(0.01, 0.08),
    floor_texture=(0.0, 1.0),
    hole_rim_mm=(-0.04, 0.06),
    hole_rim_width_mm=(0.015, 0.09),
    hole_crest_mm=(0.0, 0.05),
    soot_softness=(0.0, 1.0),
    light_scale=(0.7, 1.3),
    light_lean=(0.0, 0.9),
    second_light_share=0.4,
    veil=(0.0, 0.08),
    exposure=(0.5, 2.2),
    defocus_px=(0.3, 1.9),
)
"""As dense, with surfaces and lights wider than any one line's: a network that saw one look only is lost on the next."""

PAPER = replace(
    LINE,
    shift_mm=0.0,
    tilt_deg=0.0,
    bead_offset_mm=(0.0, 0.0),
    spectral_share=1.0,
    height_scale=(1.0, 1.0),
    shift_scale=(1.0, 1.0),
    undercut_mm=(0.0, 0.0),
    step_mm=0.0,
    overlap_mm=(0.0, 0.0),
    overlap_width=(0.0, 0.0),
    overlap_height_mm=(0.0, 0.0),
    crater_mm=(0.0, 0.0),
    spatter=(0, 0),
    bead_scratches=(0, 0),
    scratches=(0, 0),
    dust=(0, 0),
    fibres=(0, 0),
    heat_tint=(0.0, 0.0),
    circles=False,
    bead_reflectance=(0.86, 0.86),
    partner_reflectance=(0.72, 0.72),
    light_lean=(0.0, 0.0),
    veil=(0.0, 0.0),
    exposure=(0.9, 1.1),
)
"""The paper's protocol: what varies there and nothing else."""

RECIPES = {"line": LINE, "dense": DENSE, "wide": WIDE, "paper": PAPER}


def read_recipe(path: Path, base: Recipe) -> Recipe:
    """Recipe of a TOML file over `base` or the one that the file names. Raises SynthError naming key, value and range."""
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SynthError(f"{path}: not a readable recipe: {error}") from None
    name = entries.pop("base", None)
    if name is not None:
        if not isinstance(name, str) or name not in RECIPES:
            raise SynthError(f"{path}: base = {name!r}: no such recipe; known: {', '.join(RECIPES)}")
        base = RECIPES[name]
    checker = TypeAdapter(Recipe)
    try:
        return checker.validate_python({**checker.dump_python(base), **entries})
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        reason = first["msg"].removeprefix("Value error, ")
        if first["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
            reason = f"no such key; known: base, {', '.join(Recipe.__dataclass_fields__)}"
        raise SynthError(f"{path}: {key}: {reason}") from None

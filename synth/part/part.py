"""One part as data: where it lies, what its weld is like, which defects it has.

Part coordinates: x right, y down, as seen in the image, z towards the camera; origin in the ring's centre; mm.
Angles: 0 at +x, clockwise as seen in the image, degrees.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from synth.part.geometry import Geometry, Ring, StraightPiece
from synth.part.recipe import Range, Recipe
from synth.part.switches import ALL, Switch

Form = type[Ring] | type[StraightPiece]
"""Class of a part's geometry."""


class Truth(StrEnum):
    """What the part really is."""

    OK = "OK"
    HOLE = "hole"
    MISSING_WELD = "missing_weld"


@dataclass(frozen=True, slots=True)
class Hole:
    """A hole in the bead: a deformed ellipse (paper, eq. 3)."""

    angle_deg: float
    offset_mm: float
    """Of the middle of the hole from the bead's centre line, outwards positive."""
    length_mm: float
    """Along the weld."""
    width_mm: float
    """Across the weld."""
    deformation: float
    """Factor d of eq. (3), 0 to 1: 0 is an ellipse."""
    a: int
    b: int
    """Frequencies a and b of eq. (3)."""


@dataclass(frozen=True, slots=True)
class MissingWeld:
    """An arc without weld: the bare joint shows (paper, section 3.5.2). end_deg may exceed 360."""

    start_deg: float
    end_deg: float


@dataclass(frozen=True, slots=True)
class Part:
    """One part, drawn from a recipe. Fine structure grows from `seed`; see `Recipe` for the units."""

    seed: int
    center_mm: tuple[float, float]
    """(x, y) of the ring's centre in the object plane, from the optical axis, y down."""
    tilt_deg: tuple[float, float]
    """Rotation about the x and the y axis."""
    radius_mm: float
    half_width_mm: float
    crown_mm: float
    ripple_pitch_mm: float
    ripple_slope: float
    crescent_mm: float
    rough_slope: float
    wobble_mm: float
    step_mm: float
    gap_mm: float
    start_deg: float
    """Where the weld starts and, after the overlap, ends."""
    direction: int
    """+1: welded clockwise as seen in the image, -1: the other way."""
    sparsity: float
    chevron: float
    undercut_mm: float
    bead_scratches: int
    bead_reflectance: float
    partner_reflectance: float
    alpha_weld: float
    alpha_partner: float
    floor_reflectance: float
    floor_texture: float
    hole_rim_mm: float
    hole_rim_width_mm: float
    hole_crest_mm: float
    soot_softness: float
    light_scale: float
    light_lean: float
    light_heading_deg: float
    """Side on which the light is brighter, as angles in the image."""
    exposure: float
    defocus_px: float
    read_noise_dn: float
    holes: tuple[Hole, ...] = ()
    missing: tuple[MissingWeld, ...] = ()
    form: Form = Ring
    """Class of `geometry`."""
    switches: frozenset[Switch] = ALL
    material: str = "aluminium"
    spectral: bool = False
    """Relief from the measurement's spectrum, eq. (2); else ripples drawn directly."""
    height_scale: float = 1.0
    """Factor of the spectral relief's height."""
    shift_scale: float = 1.0
    """Factor of the fitted row shift."""
    bead_offset_mm: float = 0.0
    joint_wave_mm: float = 0.012
    overlap_mm: float = 0.0
    overlap_width: float = 0.0
    overlap_height_mm: float = 0.0
    crater_mm: float = 0.03
    spatter: int = 0
    fibres: int = 0
    scratches: int = 0
    dust: int = 0
    heat_tint: float = 0.0
    soot: float = 0.0
    veil: float = 0.0
    second_light: float = 0.0
    circles: bool = True

    @property
    def geometry(self) -> Geometry:
        """Where the weld's points lie."""
        return self.form(self.radius_mm)

    @property
    def truth(self) -> Truth:
        """What the part is: a missing weld weighs more than a hole."""
        if self.missing:
            return Truth.MISSING_WELD
        return Truth.HOLE if self.holes else Truth.OK


def draw_part(
    seed: int,
    truth: Truth,
    recipe: Recipe,
    switches: frozenset[Switch] = ALL,
    defects: tuple[tuple[Hole, ...], tuple[MissingWeld, ...]] | None = None,
    form: Form = Ring,
) -> Part:
    """Draw the part number `seed` with the wished truth from `recipe`. Same arguments, same part.

    `defects` (holes, missing arcs) takes the place of drawn ones. A straight piece lies in the middle of the picture.
    """
    rng = np.random.default_rng([seed, 1])
    look = np.random.default_rng([seed, 8])

    def of(bounds: Range) -> float:
        return float(rng.uniform(*bounds))

    def seen(bounds: Range) -> float:
        return float(look.uniform(*bounds))

    def some(bounds: tuple[int, int]) -> int:
        return int(look.integers(bounds[0], bounds[1] + 1))

    half_width_mm = of(recipe.half_width_mm)
    radius_mm = of(recipe.radius_mm)
    holes: tuple[Hole, ...] = ()
    missing: tuple[MissingWeld, ...] = ()
    if defects is not None:
        holes, missing = defects
    elif truth is Truth.HOLE:
        count = int(rng.integers(recipe.holes[0], recipe.holes[1] + 1))
        holes = tuple(draw_hole(rng, recipe, half_width_mm) for _ in range(count))
    elif truth is Truth.MISSING_WELD:
        missing = _draw_missing(rng, recipe)
    shift_mm = (float(rng.uniform(-1, 1)) * recipe.shift_mm, float(rng.uniform(-1, 1)) * recipe.shift_mm)
    return Part(
        seed=seed,
        center_mm=(0.0, 0.0) if form is StraightPiece else shift_mm,
        tilt_deg=(float(rng.uniform(-1, 1)) * recipe.tilt_deg, float(rng.uniform(-1, 1)) * recipe.tilt_deg),
        radius_mm=radius_mm,
        half_width_mm=half_width_mm,
        crown_mm=of(recipe.crown_mm),
        ripple_pitch_mm=of(recipe.ripple_pitch_mm),
        ripple_slope=of(recipe.ripple_slope),
        crescent_mm=of(recipe.crescent_mm),
        rough_slope=of(recipe.rough_slope),
        wobble_mm=of(recipe.wobble_mm),
        step_mm=float(rng.uniform(-1, 1)) * recipe.step_mm,
        gap_mm=of(recipe.gap_mm),
        start_deg=of((0.0, 360.0)),
        direction=1 if rng.random() < 0.5 else -1,
        sparsity=seen(recipe.sparsity),
        chevron=seen(recipe.chevron),
        undercut_mm=seen(recipe.undercut_mm),
        bead_scratches=some(recipe.bead_scratches),
        bead_reflectance=seen(recipe.bead_reflectance),
        partner_reflectance=seen(recipe.partner_reflectance),
        alpha_weld=seen(recipe.alpha_weld),
        alpha_partner=seen(recipe.alpha_partner),
        floor_reflectance=seen(recipe.floor_reflectance),
        light_scale=seen(recipe.light_scale),
        light_lean=seen(recipe.light_lean),
        light_heading_deg=seen((0.0, 360.0)),
        exposure=float(np.exp(rng.uniform(*np.log(recipe.exposure)))),
        defocus_px=of(recipe.defocus_px),
        read_noise_dn=of(recipe.read_noise_dn),
        holes=holes,
        missing=missing,
        form=form,
        switches=switches,
        material=recipe.material,
        spectral=bool(look.random() < recipe.spectral_share),
        height_scale=seen(recipe.height_scale),
        shift_scale=seen(recipe.shift_scale),
        bead_offset_mm=seen(recipe.bead_offset_mm),
        joint_wave_mm=seen(recipe.joint_wave_mm),
        overlap_mm=seen(recipe.overlap_mm),
        overlap_width=seen(recipe.overlap_width),
        overlap_height_mm=seen(recipe.overlap_height_mm),
        crater_mm=seen(recipe.crater_mm),
        spatter=some(recipe.spatter),
        fibres=some(recipe.fibres),
        scratches=some(recipe.scratches),
        dust=some(recipe.dust),
        heat_tint=seen(recipe.heat_tint),
        soot=seen(recipe.soot),
        veil=seen(recipe.veil),
        second_light=seen(recipe.second_light) if look.random() < recipe.second_light_share else 0.0,
        floor_texture=seen(recipe.floor_texture),
        hole_rim_mm=seen(recipe.hole_rim_mm),
        hole_rim_width_mm=seen(recipe.hole_rim_width_mm),
        soot_softness=seen(recipe.soot_softness),
        hole_crest_mm=seen(recipe.hole_crest_mm),
        circles=recipe.circles,
    )


def draw_hole(rng: np.random.Generator, recipe: Recipe, half_width_mm: float, angle_deg: float | None = None) -> Hole:
    """Draw a hole (paper, eq. 3), small to long, at `angle_deg` or anywhere round the ring."""
    length_mm = float(np.exp(rng.uniform(*np.log(recipe.hole_length_mm))))
    width_mm = min(length_mm * float(rng.uniform(0.8, 1.2)), float(rng.uniform(0.2, 1.1)) * half_width_mm)
    room_mm = max(0.0, 0.75 * half_width_mm - width_mm / 2)
    anywhere_deg = float(rng.uniform(0, 360))
    return Hole(
        angle_deg=anywhere_deg if angle_deg is None else angle_deg,
        offset_mm=float(rng.uniform(-1, 1)) * room_mm,
        length_mm=length_mm,
        width_mm=width_mm,
        deformation=float(rng.uniform(0, 1)),
        a=int(rng.integers(3, 6)),
        b=int(rng.integers(2, 4)),
    )


def _draw_missing(rng: np.random.Generator, recipe: Recipe) -> tuple[MissingWeld, ...]:
    if rng.random() < recipe.missing_all_share:
        return (MissingWeld(0.0, 360.0),)
    start_deg = float(rng.uniform(0, 360))
    first = MissingWeld(start_deg, start_deg + float(rng.uniform(*recipe.missing_deg)))
    if rng.random() < 0.7:
        return (first,)
    second_deg = first.end_deg + float(rng.uniform(40, 120))
    return (first, MissingWeld(second_deg, second_deg + float(rng.uniform(recipe.missing_deg[0], 60))))

"""One part as data: where it lies, what its weld is like, which defects it has.

Part coordinates: x right, y down, as seen in the image, z towards the camera; origin in the ring's centre; mm.
Angles: 0 at +x, clockwise as seen in the image, degrees.
"""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from synth.recipe import Range, Recipe


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
    light_scale: float
    light_lean: float
    light_heading_deg: float
    """Side on which the light is brighter, as angles in the image."""
    exposure: float
    defocus_px: float
    read_noise_dn: float
    holes: tuple[Hole, ...] = ()
    missing: tuple[MissingWeld, ...] = ()

    @property
    def truth(self) -> Truth:
        """What the part is: a missing weld weighs more than a hole."""
        if self.missing:
            return Truth.MISSING_WELD
        return Truth.HOLE if self.holes else Truth.OK


def draw_part(seed: int, truth: Truth, recipe: Recipe) -> Part:
    """Draw the part number `seed` with the wished truth from `recipe`. Same arguments, same part."""
    rng = np.random.default_rng([seed, 1])
    look = np.random.default_rng([seed, 8])

    def of(bounds: Range) -> float:
        return float(rng.uniform(*bounds))

    def seen(bounds: Range) -> float:
        return float(look.uniform(*bounds))

    half_width_mm = of(recipe.half_width_mm)
    radius_mm = of(recipe.radius_mm)
    holes: tuple[Hole, ...] = ()
    missing: tuple[MissingWeld, ...] = ()
    if truth is Truth.HOLE:
        count = int(rng.integers(recipe.holes[0], recipe.holes[1] + 1))
        holes = tuple(_draw_hole(rng, recipe, half_width_mm) for _ in range(count))
    elif truth is Truth.MISSING_WELD:
        missing = _draw_missing(rng, recipe)
    return Part(
        seed=seed,
        center_mm=(float(rng.uniform(-1, 1)) * recipe.shift_mm, float(rng.uniform(-1, 1)) * recipe.shift_mm),
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
        bead_scratches=int(look.integers(recipe.bead_scratches[0], recipe.bead_scratches[1] + 1)),
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
    )


def _draw_hole(rng: np.random.Generator, recipe: Recipe, half_width_mm: float) -> Hole:
    length_mm = float(np.exp(rng.uniform(*np.log(recipe.hole_length_mm))))
    width_mm = min(length_mm * float(rng.uniform(0.8, 1.2)), float(rng.uniform(0.2, 1.1)) * half_width_mm)
    room_mm = max(0.0, 0.75 * half_width_mm - width_mm / 2)
    return Hole(
        angle_deg=float(rng.uniform(0, 360)),
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

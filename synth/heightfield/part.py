"""One part as a picture with its label, grown from a seed."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from synth.heightfield.bead import BeadCells, Course, lay_bead
from synth.heightfield.grid import Grid
from synth.heightfield.harsh import add_harsh_dirt, harsh_picture, softened, steepened
from synth.heightfield.holes import FAMILIES as HOLES
from synth.heightfield.holes import DrilledHole, drill
from synth.heightfield.marks import add_circles, add_dirt, add_edge, add_spot, add_tack
from synth.heightfield.plug import add_profile
from synth.heightfield.sensor import photograph
from synth.heightfield.shade import draw_light, shade, shadow, with_side_light
from synth.heightfield.sheet import FINISHES
from synth.heightfield.sheets import Joint, make_sheets
from synth.heightfield.surface import Place, Surface
from synth.heightfield.weld import FAMILIES as WELDS
from synth.part.ranges import log_uniform, uniform
from synth.part.streams import Stream, stream


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """What pictures to draw."""

    um_per_px: float
    side_mm: float = 21.0
    factor: int = 1
    """Cells of the height field along one pixel."""
    radius_mm: tuple[float, float] = (3.2, 7.2)
    half_width_mm: tuple[float, float] = (0.24, 0.66)
    shift_mm: float = 2.0
    """How far the ring's centre lies from the picture's, at most."""
    no_weld: float = 0.12
    """Fraction of the pictures without a weld."""
    missing: float = 0.2
    """Fraction of the welds with missing bead."""
    holes: float = 0.3
    """Fraction of the welds with holes."""
    harsh: float = 0.0
    """Fraction of the pictures in which the weld is hard to find: see `synth.heightfield.harsh`."""
    bare: float = 0.0
    """Fraction of the welds of which there is nothing but the joint."""
    plugs: float = 0.0
    """Fraction of the pictures whose disc is a turned plug, with a steep bead: see the module `plug`."""
    sheets: Sequence[str] = tuple(FINISHES)
    welds: Sequence[str] = tuple(WELDS)
    hole_families: Sequence[str] = tuple(HOLES)


ORDERS = {
    "ring": Order(um_per_px=52.0, factor=2, harsh=0.5, bare=0.05),
    "plugs": Order(
        um_per_px=52.0, factor=2, half_width_mm=(0.4, 1.0), missing=0.1, holes=0.15, harsh=0.3, plugs=1.0
    ),
    "crops": Order(
        um_per_px=13.0,
        side_mm=14.6,
        radius_mm=(5.3, 5.85),
        half_width_mm=(0.28, 0.6),
        shift_mm=0.2,
        no_weld=0.0,
    ),
}
"""Pictures by what they train: whole rings of any size, coarse; those round turned plugs; and the line's
ring, at the crops' scale."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Pictured:
    """A picture (H, W) uint8 with `Place` of each pixel (H, W) uint8, and what it shows."""

    image: NDArray[np.uint8]
    place: NDArray[np.uint8]
    course: Course | None
    """The weld, in mm from the picture's middle; None without one."""
    weld: str | None
    sheet: str
    """Finish of the plate."""
    disc: str
    """Finish of the disc; that of the plate if there is no joint."""
    holes: tuple[DrilledHole, ...] = field(default=())


def picture(seed: int, order: Order) -> Pictured:
    """Draw the part number `seed`. Same arguments, same picture."""
    rng = stream(seed, Stream.HEIGHTFIELD)
    side = round(order.side_mm * 1000 / order.um_per_px) * order.factor
    grid = Grid(side, order.um_per_px / 1000 / order.factor)
    radius, half = log_uniform(rng, order.radius_mm), log_uniform(rng, order.half_width_mm)
    x, y = rng.uniform(-order.shift_mm, order.shift_mm, 2)
    joint = Joint(
        x_mm=float(x + rng.normal() * 0.05),
        y_mm=float(y + rng.normal() * 0.05),
        radius_mm=radius + float(np.clip(rng.normal() * 0.06, -0.6 * half, 0.6 * half)),
        gap_mm=uniform(rng, (0.0, 0.22)) * (rng.random() < 0.8),
        step_mm=uniform(rng, (-0.25, 0.25)) * (rng.random() < 0.5),
    )
    has_weld = rng.random() >= order.no_weld
    extra = stream(seed, Stream.HEIGHTFIELD, "harsh")
    is_harsh, is_bare = extra.random() < order.harsh, extra.random() < order.bare
    turned = stream(seed, Stream.HEIGHTFIELD, "plug")
    is_plug = turned.random() < order.plugs
    surface, (sheet, disc) = make_sheets(rng, grid, joint, order.sheets, is_joined=has_weld)
    if is_plug:
        add_profile(turned, surface, joint, radius_mm=radius - uniform(turned, (0.3, 1.3)) * half)
    add_circles(rng, surface, joint, keep_off_mm=1.25 * half)
    course, weld = None, None
    holes: tuple[DrilledHole, ...] = ()
    if has_weld:
        course = Course(
            x_mm=float(x),
            y_mm=float(y),
            radius_mm=radius,
            half_width_mm=half,
            start_deg=uniform(rng, (0, 360)),
            direction=1 if rng.random() < 0.5 else -1,
            overlap_mm=log_uniform(rng, (0.3, 6)),
            missing_deg=_missing(rng, radius) if rng.random() < order.missing else (),
        )
        if is_bare:
            course = replace(course, missing_deg=((0.0, 360.0),))
        steepness = steepened(extra) if is_harsh else 1.0
        steepness *= steepened(turned) if is_plug else 1.0
        weld, cells = lay_bead(rng, surface, course, order.welds, steepness=steepness)
        holes = _drill(rng, surface, course, cells, order)
    else:
        _add_spots(rng, surface, joint)
    if rng.random() < 0.12:
        add_tack(rng, surface, joint, half)
    for _ in range(int(turned.integers(0, 3)) if is_plug else 0):
        add_tack(turned, surface, joint, half, apart=(0.8, 2.2))
    add_dirt(rng, surface, joint, half)
    if rng.random() < 0.25:
        add_edge(rng, surface, joint, reach_mm=half + 0.3)
    if is_harsh:
        add_harsh_dirt(extra, surface, joint, half)
    light = draw_light(rng)
    if is_plug and turned.random() < 0.6:
        light = with_side_light(turned, light)
    depth = uniform(rng, (0.3, 1.5))
    radiance = shade(
        surface.height_mm, np.clip(surface.roughness, 0.05, 0.6), light, surface.x_mm, surface.y_mm
    )
    radiance *= np.clip(surface.reflectance, 0.0, 1.2) * shadow(surface.height_mm, grid.cell_mm, depth)
    image = photograph(rng, radiance, surface.x_mm, surface.y_mm, factor=order.factor)
    if is_plug and turned.random() < 0.5:
        image = softened(turned, image)
    if is_harsh:
        image = harsh_picture(extra, image)
    place = most_frequent(surface.place, order.factor)
    return Pictured(image=image, place=place, course=course, weld=weld, sheet=sheet, disc=disc, holes=holes)


def most_frequent(places: NDArray[np.uint8], factor: int) -> NDArray[np.uint8]:
    """Return the most frequent place (H / factor, W / factor) of each pixel, from those of its cells (H, W).

    One cell of each pixel would not do: none lies in the middle of 2 x 2, and the mask would be moved against
    the image, which is the mean over all of them. Among equally frequent places the highest is taken.
    """
    rows, columns = (side // factor for side in places.shape)
    cells = places.reshape(rows, factor, columns, factor)
    highest_first = tuple(Place)[::-1]
    counts = np.stack([(cells == place).sum(axis=(1, 3)) for place in highest_first])
    return np.asarray(np.array(highest_first, np.uint8)[counts.argmax(axis=0)])


def _missing(rng: np.random.Generator, radius_mm: float) -> tuple[tuple[float, float], ...]:
    """Draw arcs without bead: short to the whole ring."""
    if rng.random() < 0.08:
        return ((0.0, 360.0),)
    arcs = []
    for _ in range(int(rng.integers(1, 4))):
        start = uniform(rng, (0, 360))
        arcs.append((start, start + float(np.rad2deg(log_uniform(rng, (0.4, 12)) / radius_mm))))
    return tuple(arcs)


def _drill(
    rng: np.random.Generator, surface: Surface, course: Course, cells: BeadCells, order: Order
) -> tuple[DrilledHole, ...]:
    """Draw the holes of a weld; most welds have none."""
    if rng.random() >= order.holes:
        return ()
    made: list[DrilledHole] = []
    for _ in range(int(rng.integers(1, 7))):
        made += drill(rng, surface, course, cells, str(rng.choice(list(order.hole_families))))
    return tuple(made)


def _add_spots(rng: np.random.Generator, surface: Surface, joint: Joint) -> None:
    """Often add something round to a picture that shows no weld."""
    for _ in range(int(rng.integers(0, 3))):
        add_spot(rng, surface, joint.x_mm + float(rng.normal() * 3), joint.y_mm + float(rng.normal() * 3))

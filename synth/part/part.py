"""One part as data: where it lies, what its weld is like, which defects it has.

Part coordinates: x right, y down, as seen in the image, z towards the camera; origin in the ring's centre;
mm. Angles: 0 at +x, clockwise as seen in the image.
"""

from dataclasses import dataclass

from station.defects import KINDS
from synth.part.bead import Bead
from synth.part.defect import Defect
from synth.part.dirt import Dirt
from synth.part.geometry import Geometry, Ring, StraightPiece
from synth.part.joint import Joint
from synth.part.light import Light
from synth.part.pose import Pose
from synth.part.recipe import Recipe
from synth.part.relief import Relief
from synth.part.sensor import Sensor
from synth.part.streams import Stream, stream
from synth.part.surface import Surface
from synth.part.switches import ALL, Switch

Form = type[Ring] | type[StraightPiece]
"""Class of a part's geometry."""

GRAVITY = {kind.name: number for number, kind in enumerate(KINDS)}
"""Order of the kinds of defect, the graver later."""


@dataclass(frozen=True, slots=True)
class Part:
    """One part, drawn from a generator recipe. Fine structure grows from `seed`."""

    seed: int
    pose: Pose
    bead: Bead
    joint: Joint
    relief: Relief
    surface: Surface
    dirt: Dirt
    light: Light
    sensor: Sensor
    defects: tuple[Defect, ...] = ()
    form: Form = Ring
    switches: frozenset[Switch] = ALL

    @property
    def geometry(self) -> Geometry:
        """Where the weld's points lie."""
        return self.form(self.bead.radius_mm)

    @property
    def kind(self) -> str | None:
        """Name of the gravest kind of defect of the part, None if it is OK."""
        return max(
            (defect.kind for defect in self.defects), key=lambda name: GRAVITY.get(name, -1), default=None
        )


def draw_part(
    seed: int,
    recipe: Recipe,
    *,
    kind: str | None = None,
    defects: tuple[Defect, ...] | None = None,
    form: Form = Ring,
    switches: frozenset[Switch] = ALL,
) -> Part:
    """Draw the part number `seed` with defects of one kind, or with the given `defects`.

    Same arguments, same part. A straight piece lies in the middle of the image.
    """
    bead, pose = draw_bead(seed, recipe), recipe.pose.draw(stream(seed, Stream.POSE))
    if defects is None:
        defects = () if kind is None else recipe.defects[kind].draw(stream(seed, Stream.DEFECTS, kind), bead)
    return Part(
        seed=seed,
        pose=pose if form is Ring else pose.centered(),
        bead=bead,
        joint=recipe.joint.draw(stream(seed, Stream.JOINT)),
        relief=recipe.relief.draw(stream(seed, Stream.RELIEF)),
        surface=recipe.surface.draw(stream(seed, Stream.SURFACE)),
        dirt=recipe.dirt.draw(stream(seed, Stream.DIRT)),
        light=recipe.light.draw(stream(seed, Stream.LIGHT)),
        sensor=recipe.sensor.draw(stream(seed, Stream.SENSOR)),
        defects=defects,
        form=form,
        switches=switches,
    )


def draw_bead(seed: int, recipe: Recipe) -> Bead:
    """Draw the bead of the part number `seed` alone: what its defects need to know of it."""
    return recipe.bead.draw(stream(seed, Stream.BEAD))

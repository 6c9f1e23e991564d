"""A generator recipe as plain data: what varies from part to part, and by how much; mm and degrees."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from synth.part.bead import BeadRanges
from synth.part.defect import DefectRanges
from synth.part.dirt import DirtRanges
from synth.part.joint import JointRanges
from synth.part.light import LightRanges
from synth.part.pose import PoseRanges
from synth.part.ranges import Weight
from synth.part.relief import ReliefRanges
from synth.part.sensor import SensorRanges
from synth.part.surface import SurfaceRanges


@dataclass(frozen=True, slots=True)
class Recipe:
    """Ranges in groups, from which a part is drawn, evenly unless stated otherwise. Defaults: the line."""

    ok_weight: Weight = 1.0
    """How many parts of a lot have no defect, relative to the weights of the kinds of defect."""
    pose: PoseRanges = field(default_factory=PoseRanges)
    bead: BeadRanges = field(default_factory=BeadRanges)
    joint: JointRanges = field(default_factory=JointRanges)
    relief: ReliefRanges = field(default_factory=ReliefRanges)
    surface: SurfaceRanges = field(default_factory=SurfaceRanges)
    dirt: DirtRanges = field(default_factory=DirtRanges)
    light: LightRanges = field(default_factory=LightRanges)
    sensor: SensorRanges = field(default_factory=SensorRanges)
    defects: Mapping[str, DefectRanges] = field(default_factory=dict)
    """Ranges of each kind of defect by its name."""

    def groups(self) -> dict[str, Any]:
        """Return each group of ranges, kinds of defect included, by the name of its table in a file."""
        own = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in ("ok_weight", "defects")}
        return {**own, **self.defects}

    def tables(self) -> dict[str, Any]:
        """Return the recipe as a recipe file would state it; JSON-ready."""
        return {"ok_weight": self.ok_weight, **{name: asdict(group) for name, group in self.groups().items()}}

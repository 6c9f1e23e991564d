"""Which crops a dataset has, before anything is rendered: the shards, each one scene. Same arguments, same plan."""

from dataclasses import dataclass, replace

import numpy as np

from station.domain import SEGMENTS
from synth.errors import SynthError
from synth.part.geometry import StraightPiece
from synth.part.part import Hole, MissingWeld, Part, Truth, draw_hole, draw_part
from synth.part.recipe import Recipe
from synth.part.streams import Stream, stream
from synth.part.switches import Switch

OK, HOLE, MISSING = KINDS = ("ok", "hole", "missing_weld")
FLAT_PER_SHARD = 24
VAL_EVERY = 7
"""Every seventh shard is for validation: no part has crops on both sides."""
MIN_OVERLAP = 0.2
"""A crop shows a defect if it covers this share of the smaller of the two; a crop that is touched by less is not used."""
TOUCH_DEG = 1e-6
"""Less is rounding, not overlap."""
SEAM_SHARE = 0.2
"""Share of the flat crops in which the weld starts and ends; of a ring's it is one in 21, too few to learn its crater."""
SEAM_DEG = 7.0
RING_ERROR_PX = 3.0
"""Largest error of the ring's centre and radius that arcs are cut with: the station's own is smaller."""
RING_ERROR_DEG = 0.7
"""What it moves a crop along the ring: crops whose kind that would change are not used."""


@dataclass(frozen=True, slots=True)
class Crop:
    """One image: its number in the dataset, its kind, and its segment of the ring or tile of the scene."""

    number: int
    kind: str
    place: int


@dataclass(frozen=True, slots=True)
class Shard:
    """One scene: a ring seen whole, or flat crops side by side."""

    index: int
    parts: tuple[Part, ...]
    crops: tuple[Crop, ...]

    @property
    def is_straight(self) -> bool:
        """True if the scene shows straight pieces."""
        return self.parts[0].form is StraightPiece

    @property
    def split(self) -> str:
        """Whether its crops train or validate."""
        return "val" if self.index % VAL_EVERY == VAL_EVERY - 1 else "train"


def quotas(count: int, shares: tuple[float, float, float]) -> dict[str, int]:
    """Number of crops of each kind; half, a quarter and a quarter in the paper (section 6)."""
    if count < 1:
        raise SynthError(f"--count is {count}; at least 1 is needed")
    total = sum(shares)
    hole, missing = (round(count * share / total) for share in shares[1:])
    return {OK: count - hole - missing, HOLE: hole, MISSING: missing}


def plan_flat(seed: int, wanted: dict[str, int], recipe: Recipe, switches: frozenset[Switch]) -> list[Shard]:
    """The paper's crops: each a straight piece of its own weld."""
    rng = stream(seed, Stream.STRAIGHT_PLAN)
    kinds = [kind for kind, count in wanted.items() for _ in range(count)]
    rng.shuffle(kinds)
    shards: list[Shard] = []
    for start in range(0, len(kinds), FLAT_PER_SHARD):
        chosen = kinds[start : start + FLAT_PER_SHARD]
        parts = tuple(_flat_part(seed * 10_000_000 + start + i, kind, recipe, switches) for i, kind in enumerate(chosen))
        crops = tuple(Crop(start + i, kind, i) for i, kind in enumerate(chosen))
        shards.append(Shard(len(shards), parts, crops))
    return shards


def _flat_part(seed: int, kind: str, recipe: Recipe, switches: frozenset[Switch]) -> Part:
    rng = stream(seed, Stream.STRAIGHT_PIECE)
    half_width_mm = draw_part(seed, Truth.OK, recipe, switches, ((), ())).half_width_mm
    holes: tuple[Hole, ...] = ()
    missing: tuple[MissingWeld, ...] = ()
    if kind == HOLE:
        count = int(rng.integers(1, 3))
        holes = tuple(draw_hole(rng, recipe, half_width_mm, float(rng.uniform(-6.5, 6.5))) for _ in range(count))
    elif kind == MISSING:
        edge = float(rng.uniform(-3, 8)) if rng.random() < 0.35 else 90.0
        missing = (MissingWeld(-90.0, edge) if rng.random() < 0.5 else MissingWeld(-edge, 90.0),)
    part = draw_part(seed, Truth.OK, recipe, switches, (holes, missing), form=StraightPiece)
    if rng.random() < SEAM_SHARE:
        part = replace(part, start_deg=float(rng.uniform(-SEAM_DEG, SEAM_DEG)))
    return part


def plan_arcs(seed: int, wanted: dict[str, int], recipe: Recipe, switches: frozenset[Switch]) -> list[Shard]:
    """Crops of whole rings, as the station cuts them: each ring has several defects and gives what is still wanted."""
    left = dict(wanted)
    shards: list[Shard] = []
    number = 0
    while any(left.values()):
        index = len(shards)
        rng = stream(seed, Stream.RING_PLAN, index)
        part = _ring(seed * 10_000_000 + index, rng, recipe, switches, left)
        crops = []
        for segment in rng.permutation(SEGMENTS):
            start_deg, end_deg = int(segment) * 360 / SEGMENTS, (int(segment) + 1) * 360 / SEGMENTS
            kind = crop_kind(part, start_deg, end_deg)
            sure = {crop_kind(part, start_deg - d, end_deg + d) for d in (-RING_ERROR_DEG, RING_ERROR_DEG)} == {kind}
            if kind is not None and sure and left[kind] > 0:
                left[kind] -= 1
                crops.append(Crop(number, kind, int(segment)))
                number += 1
        shards.append(Shard(index, (part,), tuple(crops)))
    return [shard for shard in shards if shard.crops]


def _ring(seed: int, rng: np.random.Generator, recipe: Recipe, switches: frozenset[Switch], left: dict[str, int]) -> Part:
    """A ring whose defects are about as many as its share of what is left."""
    total = max(1, sum(left.values()))
    half_width_mm = draw_part(seed, Truth.OK, recipe, switches, ((), ())).half_width_mm
    missing: tuple[MissingWeld, ...] = ()
    share = left[MISSING] / total
    if share > 0:
        if rng.random() < recipe.missing_all_share * share:
            missing = (MissingWeld(0.0, 360.0),)
        else:
            arc = min(330.0, max(24.0, 360.0 * share * float(rng.uniform(0.6, 1.6))))
            at = float(rng.uniform(0, 360))
            missing = (MissingWeld(at, at + arc),)
            if arc > 60 and rng.random() < 0.5:
                missing = (MissingWeld(at, at + arc / 2), MissingWeld(at + 180, at + 180 + arc / 2))
    count = int(rng.binomial(SEGMENTS, min(0.9, 1.15 * left[HOLE] / total)))
    holes = tuple(draw_hole(rng, recipe, half_width_mm) for _ in range(count))
    free = tuple(h for h in holes if not any((h.angle_deg - a.start_deg + 4) % 360 < a.end_deg - a.start_deg + 8 for a in missing))
    return draw_part(seed, Truth.OK, recipe, switches, (free, missing))


def crop_kind(part: Part, start_deg: float, end_deg: float) -> str | None:
    """Kind of the crop over an arc; a missing weld weighs more than a hole; None if a defect only just touches it."""
    kind, touched = OK, False
    spans = [(HOLE, h.angle_deg, np.rad2deg(h.length_mm / part.radius_mm)) for h in part.holes]
    spans += [(MISSING, (a.start_deg + a.end_deg) / 2, a.end_deg - a.start_deg) for a in part.missing]
    width, middle = end_deg - start_deg, (start_deg + end_deg) / 2
    for name, at, length in spans:
        away = abs((at - middle + 180) % 360 - 180)
        overlap = width if length >= 360 else float(np.clip((width + length) / 2 - away, 0, min(width, length)))
        if overlap >= MIN_OVERLAP * min(width, length):
            kind = name if kind != MISSING else kind
        elif overlap > TOUCH_DEG:
            touched = True
    return None if kind == OK and touched else kind

"""The plan of a dataset, before anything is rendered: shards, each one scene. Same arguments, same plan."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from station.classify.crop_label import OK, crop_label
from station.defects import KINDS
from station.domain import SEGMENT_DEG, SEGMENTS
from synth.errors import SynthError
from synth.part.bead import Bead
from synth.part.defect import Defect
from synth.part.geometry import StraightPiece
from synth.part.part import Part, draw_bead, draw_part
from synth.part.recipe import Recipe
from synth.part.streams import Stream, stream
from synth.part.switches import Switch

CROP_KINDS = (OK, *(kind.name for kind in KINDS))
"""What a crop may show."""
OK_FRACTION = 0.5
"""Fraction of the crops that are OK; the kinds of defect share the others evenly (paper, section 6)."""
PIECES_PER_SHARD = 24
VAL_EVERY = 7
"""Every seventh shard is for validation: no part has crops on both sides."""
SEAM_FRACTION = 0.2
"""Fraction of the straight pieces with the weld's ends; of a ring's crops 1 in 21, too few to learn from."""
SEAM_DEG = 7.0
"""Largest angle between the weld's end and the middle of such a piece."""
CLEAR_DEG = 4.0
"""A defect whose middle lies this close to a graver one is left out: there may be no bead to hold it."""
RING_ERROR_PX = 3.0
"""Largest error of the ring's centre and radius that crops are cut with: the station's own is smaller."""
RING_ERROR_DEG = 0.7
"""How far that error moves a crop along the ring: crops whose kind it would change are not used."""


@dataclass(frozen=True, slots=True)
class Crop:
    """One image: its number in the dataset, what it shows, its segment of the ring or tile of the scene."""

    number: int
    kind: str
    place: int


@dataclass(frozen=True, slots=True)
class Shard:
    """One scene: a whole ring, or straight pieces side by side."""

    index: int
    parts: tuple[Part, ...]
    crops: tuple[Crop, ...]

    @property
    def is_straight(self) -> bool:
        """True if the scene shows straight pieces."""
        return self.parts[0].form is StraightPiece

    @property
    def split(self) -> str:
        """The side that its crops are on: "train" or "val"."""
        return "val" if self.index % VAL_EVERY == VAL_EVERY - 1 else "train"


def crop_fractions() -> dict[str, float]:
    """Return the fraction of a dataset's crops of each kind: with two kinds, a half and two quarters."""
    return {OK: OK_FRACTION, **{kind.name: (1 - OK_FRACTION) / len(KINDS) for kind in KINDS}}


def quotas(count: int) -> dict[str, int]:
    """Return the number of crops of each kind; the OK ones take what rounding leaves."""
    if count < 1:
        raise SynthError(f"--count is {count}; at least 1 is needed")
    defective = {kind: round(count * fraction) for kind, fraction in crop_fractions().items() if kind != OK}
    return {OK: count - sum(defective.values()), **defective}


def plan_pieces(
    seed: int, ordered: Mapping[str, int], recipe: Recipe, switches: frozenset[Switch]
) -> list[Shard]:
    """Plan the paper's crops: each a straight piece of a weld of its own."""
    kinds = [kind for kind, count in ordered.items() for _ in range(count)]
    stream(seed, Stream.PIECE_PLAN).shuffle(kinds)
    shards: list[Shard] = []
    for start in range(0, len(kinds), PIECES_PER_SHARD):
        chosen = list(enumerate(kinds[start : start + PIECES_PER_SHARD]))
        parts = tuple(_piece(seed * 10_000_000 + start + i, kind, recipe, switches) for i, kind in chosen)
        crops = tuple(Crop(start + i, kind, i) for i, kind in chosen)
        shards.append(Shard(len(shards), parts, crops))
    return shards


def _piece(seed: int, kind: str, recipe: Recipe, switches: frozenset[Switch]) -> Part:
    defects: tuple[Defect, ...] = ()
    if kind != OK:
        defects = recipe.defects[kind].draw_on_piece(
            stream(seed, Stream.DEFECTS, kind), draw_bead(seed, recipe)
        )
    part = draw_part(seed, recipe, defects=defects, form=StraightPiece, switches=switches)
    rng = stream(seed, Stream.PIECE_SEAM)
    if rng.random() < SEAM_FRACTION:
        return replace(part, bead=replace(part.bead, start_deg=float(rng.uniform(-SEAM_DEG, SEAM_DEG))))
    return part


def plan_rings(
    seed: int, ordered: Mapping[str, int], recipe: Recipe, switches: frozenset[Switch]
) -> list[Shard]:
    """Plan crops of whole rings, cut as the station cuts them.

    Each ring has several defects and gives those crops that are still missing.
    """
    left = dict(ordered)
    shards: list[Shard] = []
    number = 0
    while any(left.values()):
        index = len(shards)
        part_seed = seed * 10_000_000 + index
        defects = _ring_defects(part_seed, recipe, left)
        part = draw_part(part_seed, recipe, defects=defects, switches=switches)
        crops = []
        for segment in stream(seed, Stream.RING_PLAN, index).permutation(SEGMENTS):
            kind = sure_kind(part, int(segment) * SEGMENT_DEG, (int(segment) + 1) * SEGMENT_DEG)
            if kind is not None and left[kind] > 0:
                left[kind] -= 1
                crops.append(Crop(number, kind, int(segment)))
                number += 1
        shards.append(Shard(index, (part,), tuple(crops)))
    return [shard for shard in shards if shard.crops]


def _ring_defects(seed: int, recipe: Recipe, left: Mapping[str, int]) -> tuple[Defect, ...]:
    """Draw the defects of a ring: of each kind about its fraction of the crops that are left to make."""
    bead = draw_bead(seed, recipe)
    total = max(1, sum(left.values()))
    found: tuple[Defect, ...] = ()
    for kind in reversed(KINDS):
        rng = stream(seed, Stream.DEFECTS, kind.name)
        drawn = recipe.defects[kind.name].draw_on_ring(rng, bead, left[kind.name] / total)
        found = (*(defect for defect in drawn if _is_clear(defect, found, bead)), *found)
    return found


def _is_clear(defect: Defect, graver: tuple[Defect, ...], bead: Bead) -> bool:
    """Return whether the middle of a defect lies clear of all graver ones."""
    middle = sum(defect.span_deg(bead)) / 2
    spans = [other.span_deg(bead) for other in graver]
    return not any((middle - first + CLEAR_DEG) % 360 < last - first + 2 * CLEAR_DEG for first, last in spans)


def sure_kind(part: Part, start_deg: float, end_deg: float) -> str | None:
    """Return what the crop of an arc shows, or None if that would change with a small error of the ring."""
    spans = [(defect.kind, *defect.span_deg(part.bead)) for defect in part.defects]
    moves = (-RING_ERROR_DEG, 0.0, RING_ERROR_DEG)
    found = {crop_label(spans, start_deg - move, end_deg + move) for move in moves}
    return found.pop() if len(found) == 1 else None

"""Which module draws which kind of defect: the only list of them in the generator.

A new kind needs a module here with its `Defect`, its `DefectRanges` and its `RANGES` of the named generator
recipes, and a line below; the rest of the generator loops over `station.defects.KINDS`.
"""

from collections.abc import Mapping

from station.defects import KINDS
from synth.defects import hole, missing_weld
from synth.part.defect import DefectRanges

RANGES: Mapping[str, Mapping[str, DefectRanges]] = {
    "hole": hole.RANGES,
    "missing_weld": missing_weld.RANGES,
}
"""Ranges of each kind of defect, by its name and by the name of the generator recipe."""


def ranges_of(recipe: str) -> dict[str, DefectRanges]:
    """Return the ranges of every kind of defect for a named recipe; if a kind has none, those of the line."""
    return {kind.name: RANGES[kind.name].get(recipe, RANGES[kind.name]["line"]) for kind in KINDS}

"""Recipe files: TOML with what differs from a named generator recipe.

`base` names that recipe, `ok_weight` stands alone, and every group of ranges is a table: `[bead]`, `[light]`,
and one for each kind of defect, as `[hole]`. Files of older versions, whose keys all stood alone under names
of their own, are still read.
"""

import tomllib
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import to_json

from synth.errors import SynthError
from synth.part.ranges import Weight
from synth.part.recipe import Recipe
from synth.recipes.named import RECIPES

_UNCHANGED = {
    "pose": "shift_mm tilt_deg",
    "bead": "radius_mm half_width_mm crown_mm wobble_mm undercut_mm overlap_mm overlap_width"
    " overlap_height_mm crater_mm",
    "joint": "step_mm gap_mm",
    "relief": "height_scale shift_scale ripple_pitch_mm ripple_slope crescent_mm sparsity chevron"
    " rough_slope",
    "surface": "material bead_reflectance partner_reflectance alpha_weld alpha_partner floor_reflectance"
    " floor_texture circles",
    "dirt": "soot soot_softness heat_tint spatter bead_scratches scratches dust fibres",
    "sensor": "veil exposure defocus_px read_noise_dn",
}
OLD_KEYS: dict[str, tuple[str, str]] = {
    **{key: (group, key) for group, keys in _UNCHANGED.items() for key in keys.split()},
    "bead_offset_mm": ("bead", "offset_mm"),
    "joint_wave_mm": ("joint", "wave_mm"),
    "spectral_share": ("relief", "spectral_fraction"),
    "light_scale": ("light", "scale"),
    "light_lean": ("light", "lean"),
    "second_light_share": ("light", "second_fraction"),
    "second_light": ("light", "second"),
    "holes": ("hole", "count"),
    "hole_length_mm": ("hole", "length_mm"),
    "hole_rim_mm": ("hole", "rim_mm"),
    "hole_rim_width_mm": ("hole", "rim_width_mm"),
    "hole_crest_mm": ("hole", "crest_mm"),
    "missing_deg": ("missing_weld", "arc_deg"),
    "missing_all_share": ("missing_weld", "all_round_fraction"),
}
"""Keys of older recipe files, and the table and key where their value is today."""


def read_recipe(path: Path, base: Recipe) -> Recipe:
    """Read a recipe file over `base` or the recipe that the file names.

    Raises SynthError naming key, value and range.
    """
    try:
        entries = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise SynthError(f"{path}: not a readable recipe: {error}") from None
    name = entries.pop("base", None)
    if name is not None:
        if not isinstance(name, str) or name not in RECIPES:
            raise SynthError(f"{path}: base = {name!r}: no such recipe; known: {', '.join(RECIPES)}")
        base = RECIPES[name]
    try:
        return _laid_over(base, _in_tables(entries))
    except _RecipeError as error:
        raise SynthError(f"{path}: {error}") from None


class _RecipeError(ValueError):
    """Which key is wrong, and why."""


def _in_tables(entries: dict[str, Any]) -> dict[str, Any]:
    """Return the entries with the keys of older files in their tables."""
    tables = {
        key: dict(value) if isinstance(value, dict) else value
        for key, value in entries.items()
        if key not in OLD_KEYS
    }
    for old in entries.keys() & OLD_KEYS.keys():
        group, key = OLD_KEYS[old]
        table = tables.setdefault(group, {})
        if isinstance(table, dict):
            if key in table:
                raise _RecipeError(
                    f"{old}: is the older name of {group}.{key}, which is given too; keep one of them"
                )
            table[key] = entries[old]
    return tables


def _laid_over(base: Recipe, tables: dict[str, Any]) -> Recipe:
    groups = base.groups()
    unknown = [key for key in tables if key not in ("ok_weight", *groups)]
    if unknown:
        raise _RecipeError(
            f"{unknown[0]}: no such key; known: base, ok_weight, {', '.join(f'[{name}]' for name in groups)}"
        )
    changed = {name: _group(name, groups[name], tables[name]) for name in groups if name in tables}
    ok_weight = _checked(TypeAdapter(Weight), tables.get("ok_weight", base.ok_weight), "ok_weight", "")
    own = {name: group for name, group in changed.items() if name not in base.defects}
    defects = {name: changed.get(name, ranges) for name, ranges in base.defects.items()}
    return replace(base, ok_weight=ok_weight, defects=defects, **own)


def _group(name: str, base: Any, table: Any) -> Any:
    if not isinstance(table, dict):
        raise _RecipeError(f"{name} = {table!r}: is a table of ranges; write [{name}] and its keys below")
    known = [f.name for f in fields(base)]
    values = {key: getattr(base, key) for key in known}
    return _checked(TypeAdapter(type(base)), {**values, **table}, name, ", ".join(known))


def _checked(checker: TypeAdapter[Any], value: Any, name: str, known: str) -> Any:
    try:
        text = to_json(value, inf_nan_mode="constants")  # a TOML list is a range, as a JSON list is
        return checker.validate_json(text, strict=True)
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join([name, *(str(part) for part in first["loc"])])
        reason = first["msg"].removeprefix("Value error, ")
        if first["type"] in ("extra_forbidden", "unexpected_keyword_argument"):
            reason = f"no such key; known: {known}"
        raise _RecipeError(f"{key}: {reason}") from None

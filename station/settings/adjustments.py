"""Reads the changes made at the station: a small JSON file next to the settings file that overrides it.

Only `station.engine.settings_change` writes this file.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeGuard

from station.errors import SettingsError
from station.numbers import without_twins
from station.settings.model import merged
from station.settings.renamed import with_new_names

SECTIONS = ("weld", "quality", "model")
"""Sections of a recipe that can be changed at the station."""


def path_of(settings: Path) -> Path:
    """Return the path of the changes to a settings file: station.adjusted.json for station.toml."""
    return settings.with_suffix(".adjusted.json")


def read(settings: Path) -> dict[str, Any]:
    """Return the changes made at the station to a settings file, empty if there are none.

    They have the form {"camera": {key: value}, "recipes": {number: {section: {key: value}}}}.
    Raises SettingsError.
    """
    path = path_of(settings)
    try:
        changes = json.loads(path.read_text(), object_pairs_hook=without_twins)
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise SettingsError(
            f"{path}: cannot be read ({error}); restore it, or delete it to return to the settings file"
        ) from None
    if not _has_the_form(changes):
        raise SettingsError(
            f"{path}: not a file of changes made at the station; delete it to return to the settings file"
        )
    return with_new_names(changes)


def _has_the_form(changes: object) -> TypeGuard[dict[str, Any]]:
    if not isinstance(changes, dict) or not set(changes) <= {"camera", "recipes"}:
        return False
    recipes = changes.get("recipes", {})
    if not isinstance(changes.get("camera", {}), dict) or not isinstance(recipes, dict):
        return False
    sections = [
        section
        for recipe in recipes.values()
        for section in (recipe.items() if isinstance(recipe, dict) else [(None, None)])
    ]
    return all(name in SECTIONS and isinstance(values, dict) for name, values in sections)


def words(settings: Path) -> list[str]:
    """Return one line per changed value, such as "model.limits.hole.threshold = 0.5 (recipe 1)".

    Raises SettingsError.
    """
    changes = read(settings)
    lines = [f"camera.{key} = {value}" for key, value in changes.get("camera", {}).items()]
    for number, sections in changes.get("recipes", {}).items():
        for section, values in sections.items():
            lines += [f"{section}.{key} = {value} (recipe {number})" for key, value in _leaves(values)]
    return lines


def _leaves(values: Mapping[str, Any]) -> Iterator[tuple[str, object]]:
    """Yield the values of a section; limits of defect kinds have dotted keys."""
    for key, value in values.items():
        if key == "limits" and isinstance(value, Mapping):
            for kind, own in value.items():
                yield from ((f"limits.{kind}.{name}", limit) for name, limit in dict(own).items())
        else:
            yield key, value


def laid_over(raw: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings `raw`, overridden by the changes."""
    settings = dict(raw)
    if changes.get("camera"):
        settings["camera"] = {**raw.get("camera", {}), **changes["camera"]}
    for number, sections in changes.get("recipes", {}).items():
        recipes = dict(settings.get("recipes", {}))
        recipe = dict(recipes.get(number, {}))
        for section, values in sections.items():
            recipe[section] = merged(recipe.get(section, {}), values)
        settings["recipes"] = {**recipes, number: recipe}
    return settings


def at(changes: Mapping[str, Any], place: Sequence[str]) -> object:
    """Return the value at a place such as ("recipes", "1", "quality", "min_sharpness"), or None."""
    value: Any = changes
    for name in place:
        value = value.get(name) if isinstance(value, Mapping) else None
    return value


def put(changes: Mapping[str, Any], place: Sequence[str], value: object) -> dict[str, Any]:
    """Return the changes with this value at a place; None removes the value there."""
    name, rest = place[0], place[1:]
    inner = put(changes.get(name, {}), rest, value) if rest else value
    others = {key: other for key, other in changes.items() if key != name}
    return others if inner is None or (inner == {} and rest) else others | {name: inner}

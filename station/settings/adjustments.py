"""What was changed at the station: a small JSON file next to the settings file, laid over it when it is read.

Read here; `settings_change` alone writes it.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeGuard

from station.errors import SettingsError
from station.settings.model import merged
from station.settings.renamed import with_new_names

SECTIONS = ("weld", "quality", "model")


def path_of(settings: Path) -> Path:
    """station.toml has station.adjusted.json."""
    return settings.with_suffix(".adjusted.json")


def read(settings: Path) -> dict[str, Any]:
    """{"camera": {key: value}, "recipes": {number: {section: {key: value}}}}; empty if nothing was changed. Raises SettingsError."""
    path = path_of(settings)
    try:
        found = json.loads(path.read_text())
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise SettingsError(
            f"{path}: cannot be read ({error}); restore it, or remove it to go back to the settings file"
        ) from None
    if not _is_ours(found):
        raise SettingsError(
            f"{path}: is not what the station writes; remove it to go back to the settings file"
        )
    return with_new_names(found)


def _is_ours(found: object) -> TypeGuard[dict[str, Any]]:
    if not isinstance(found, dict) or not set(found) <= {"camera", "recipes"}:
        return False
    recipes = found.get("recipes", {})
    if not isinstance(found.get("camera", {}), dict) or not isinstance(recipes, dict):
        return False
    sections = [
        section
        for recipe in recipes.values()
        for section in (recipe.items() if isinstance(recipe, dict) else [(None, None)])
    ]
    return all(name in SECTIONS and isinstance(values, dict) for name, values in sections)


def words(settings: Path) -> list[str]:
    """What was changed, one line a value, as model.limits.hole.threshold = 0.5 (recipe 1). Raises SettingsError."""
    found = read(settings)
    lines = [f"camera.{key} = {value}" for key, value in found.get("camera", {}).items()]
    for number, sections in found.get("recipes", {}).items():
        for section, values in sections.items():
            lines += [f"{section}.{key} = {value} (recipe {number})" for key, value in _leaves(values)]
    return lines


def _leaves(values: Mapping[str, Any]) -> Iterator[tuple[str, object]]:
    """Yield a section's values, the limits of each kind of defect by their dotted keys."""
    for key, value in values.items():
        if key == "limits" and isinstance(value, Mapping):
            for kind, own in value.items():
                yield from ((f"limits.{kind}.{name}", limit) for name, limit in dict(own).items())
        else:
            yield key, value


def laid_over(raw: dict[str, Any], changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings as read, with the changes in their places."""
    answer = dict(raw)
    if changes.get("camera"):
        answer["camera"] = {**raw.get("camera", {}), **changes["camera"]}
    for number, sections in changes.get("recipes", {}).items():
        recipes = dict(answer.get("recipes", {}))
        recipe = dict(recipes.get(number, {}))
        for section, values in sections.items():
            recipe[section] = merged(recipe.get(section, {}), values)
        answer["recipes"] = {**recipes, number: recipe}
    return answer


def at(changes: Mapping[str, Any], place: Sequence[str]) -> object:
    """The value at ("recipes", "1", "model", "limits", "hole", "threshold"), or None."""
    found: Any = changes
    for name in place:
        found = found.get(name) if isinstance(found, Mapping) else None
    return found


def put(changes: Mapping[str, Any], place: Sequence[str], value: object) -> dict[str, Any]:
    """The same with another value there; None takes it out."""
    name, rest = place[0], place[1:]
    inner = put(changes.get(name, {}), rest, value) if rest else value
    return {k: v for k, v in changes.items() if k != name} | (
        {} if inner is None or (inner == {} and rest) else {name: inner}
    )

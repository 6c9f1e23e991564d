"""What was changed at the station: a small JSON file beside the settings file, laid over it when it is read."""

import json
import os
from pathlib import Path
from typing import Any

from station.errors import SettingsError

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
        raise SettingsError(f"{path}: cannot be read ({error}); restore it, or remove it to go back to the settings file") from None
    if not isinstance(found, dict) or not all(isinstance(part, dict) for part in found.values()):
        raise SettingsError(f"{path}: is not what the station writes; remove it to go back to the settings file")
    return found


def laid_over(raw: dict[str, Any], settings: Path) -> dict[str, Any]:
    """The settings as read, with the changes in their places. Raises SettingsError."""
    changes = read(settings)
    answer = dict(raw)
    if changes.get("camera"):
        answer["camera"] = {**raw.get("camera", {}), **changes["camera"]}
    for number, sections in changes.get("recipes", {}).items():
        recipes = dict(answer.get("recipes", {}))
        recipe = dict(recipes.get(number, {}))
        for section, values in sections.items():
            recipe[section] = {**recipe.get(section, {}), **values}
        answer["recipes"] = {**recipes, number: recipe}
    return answer


def write(settings: Path, changes: dict[str, Any]) -> None:
    """Replace all changes at once, durably. Raises SettingsError."""
    path = path_of(settings)
    part = path.with_name(path.name + ".new")
    try:
        with part.open("w") as file:
            file.write(json.dumps(changes, indent=1, sort_keys=True))
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        raise SettingsError(f"{path}: cannot be written ({error.strerror}); nothing was changed") from None

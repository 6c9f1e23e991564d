"""Names that settings had before, so that old settings files and old changes at the station are still read; pure."""

from collections.abc import Mapping
from typing import Any

from station.errors import SettingsError

LIMITS = {
    "hole_threshold": ("hole", "threshold"),
    "missing_threshold": ("missing_weld", "threshold"),
    "hole_min_mm": ("hole", "min_mm"),
    "missing_min_mm": ("missing_weld", "min_mm"),
}
"""Keys of [model] before [model.limits.KIND] took their place."""


def with_new_names(raw: Mapping[str, Any]) -> dict[str, Any]:
    """Return a settings table, or the changes made at the station, with today's names.

    Raises SettingsError if a value is given under its old and its new name.
    """
    answer = dict(raw)
    if isinstance(raw.get("model"), Mapping):
        answer["model"] = _model(raw["model"], "model")
    if isinstance(raw.get("recipes"), Mapping):
        answer["recipes"] = {
            number: {**recipe, "model": _model(recipe["model"], f"recipes.{number}.model")}
            if isinstance(recipe, Mapping) and isinstance(recipe.get("model"), Mapping)
            else recipe
            for number, recipe in raw["recipes"].items()
        }
    return answer


def _model(section: Mapping[str, Any], place: str) -> dict[str, Any]:
    answer = {key: value for key, value in section.items() if key not in LIMITS}
    for old, (kind, key) in LIMITS.items():
        if old not in section:
            continue
        limits = answer.setdefault("limits", {})
        if not isinstance(limits, Mapping) or not isinstance(limits.get(kind, {}), Mapping):
            return dict(section)  # refused by the checks that follow, which name the place
        if key in limits.get(kind, {}):
            raise SettingsError(
                f"{place}.{old} is the old name of {place}.limits.{kind}.{key}; give one of them"
            )
        answer["limits"] = {**limits, kind: {**limits.get(kind, {}), key: section[old]}}
    return answer

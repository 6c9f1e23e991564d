"""Former names of settings, so that old settings files and old changes can still be read; pure."""

from collections.abc import Mapping
from typing import Any

from station.errors import SettingsError

LIMITS = {
    "hole_threshold": ("hole", "threshold"),
    "missing_threshold": ("missing_weld", "threshold"),
    "hole_min_mm": ("hole", "min_mm"),
    "missing_min_mm": ("missing_weld", "min_mm"),
}
"""Former keys of [model], with defect kind and key under [model.limits.KIND] that replace them."""


def with_new_names(raw: Mapping[str, Any]) -> dict[str, Any]:
    """Return settings, or changes made at the station, with the current names.

    Raises SettingsError if a value is given under its old and its new name.
    """
    result = dict(raw)
    if isinstance(raw.get("model"), Mapping):
        result["model"] = _model(raw["model"], "model")
    if isinstance(raw.get("recipes"), Mapping):
        result["recipes"] = {
            number: {**recipe, "model": _model(recipe["model"], f"recipes.{number}.model")}
            if isinstance(recipe, Mapping) and isinstance(recipe.get("model"), Mapping)
            else recipe
            for number, recipe in raw["recipes"].items()
        }
    return result


def _model(section: Mapping[str, Any], place: str) -> dict[str, Any]:
    result = {key: value for key, value in section.items() if key not in LIMITS}
    for old, (kind, key) in LIMITS.items():
        if old not in section:
            continue
        limits = result.setdefault("limits", {})
        if not isinstance(limits, Mapping) or not isinstance(limits.get(kind, {}), Mapping):
            return dict(section)  # the checks that follow refuse it and name the place
        if key in limits.get(kind, {}):
            raise SettingsError(
                f"{place}.{old} is the old name of {place}.limits.{kind}.{key}; give only one of them"
            )
        result["limits"] = {**limits, kind: {**limits.get(kind, {}), key: section[old]}}
    return result

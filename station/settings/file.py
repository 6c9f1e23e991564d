"""Reads station.toml. Relative paths count from the file's folder."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from station.errors import SettingsError
from station.settings.adjustments import laid_over, path_of, read
from station.settings.model import Settings, for_recipe
from station.settings.renamed import with_new_names


def load(path: Path, changes: dict[str, Any] | None = None) -> Settings:
    """Return a TOML file with what was changed at the station laid over it.

    `changes` replace what was changed at the station, before they are written. Raises SettingsError naming file,
    key and what is allowed.
    """
    try:
        with path.open("rb") as file:
            raw = tomllib.load(file)
    except FileNotFoundError:
        raise SettingsError(
            f"{path}: no such settings file; name one with -c, or copy deploy/station.toml"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"{path}: cannot be read: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"{path}: not valid TOML: {error}") from None
    over = read(path) if changes is None else changes
    try:
        raw = with_new_names(raw)
    except SettingsError as error:
        raise SettingsError(f"{path}: {error}") from None
    raw = laid_over(raw, over)
    try:
        settings = Settings.model_validate(raw)
        for number in settings.recipes:
            for_recipe(settings, number)
    except ValidationError as error:
        if changes is not None:
            raise SettingsError(_first(error)) from None
        name = path_of(path).name
        also = f" (with what was changed at the station: {name}; remove it to go back)" if over else ""
        raise SettingsError(f"{path}{also}: {_first(error)}") from None
    return _anchored(settings, path.resolve().parent)


def _first(error: ValidationError) -> str:
    def told(e: ErrorDetails) -> str:
        section, *keys = e["loc"] or ("",)
        if section == "camera":
            keys = keys[1:]  # the first is the camera's kind
        place = ".".join(map(str, (section, *keys)))
        return f"{place}: {e['msg'].removeprefix('Value error, ')}"

    return "; ".join(map(told, error.errors()))


def _under(folder: Path, values: dict[str, Any]) -> dict[str, Path]:
    """Return the paths among a section's values, counted from the folder."""
    named = {
        key: value for key, value in values.items() if key in ("path", "folder") or key.endswith("_path")
    }
    return {key: folder / value for key, value in named.items() if value is not None}


def _anchored(settings: Settings, folder: Path) -> Settings:
    model = settings.model
    changes: dict[str, Any] = {
        "model": model.model_copy(update=_under(folder, dict(model))),
        "recipes": {
            number: recipe.model_copy(update={"model": {**recipe.model, **_under(folder, recipe.model)}})
            for number, recipe in settings.recipes.items()
        },
        "archive": settings.archive.model_copy(update=_under(folder, dict(settings.archive))),
        "camera": settings.camera.model_copy(update=_under(folder, dict(settings.camera))),
    }
    tls = settings.plc.tls
    if tls is not None:
        anchored = tls.model_copy(update=_under(folder, dict(tls)))
        changes["plc"] = settings.plc.model_copy(update={"tls": anchored})
    return settings.model_copy(update=changes)

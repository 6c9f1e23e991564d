"""Reads station.toml; relative paths are resolved against the folder of the file."""

import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from station.errors import SettingsError
from station.settings.adjustments import laid_over, path_of, read
from station.settings.model import Settings, for_recipe
from station.settings.renamed import with_new_names
from station.settings.view import check_view


def load(path: Path, changes: dict[str, Any] | None = None) -> Settings:
    """Return the settings in a TOML file, overridden by the changes made at the station.

    `changes`, if given, are used instead of the stored changes, to check them before they are written.
    Raises SettingsError with file, key and the values that are allowed.
    """
    try:
        with path.open("rb") as file:
            raw = tomllib.load(file)
    except FileNotFoundError:
        raise SettingsError(
            f"{path}: settings file not found; name one with -c, or copy deploy/station.toml"
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise SettingsError(f"{path}: cannot be read: {error}") from None
    except tomllib.TOMLDecodeError as error:
        raise SettingsError(f"{path}: not valid TOML: {error}") from None
    overrides = read(path) if changes is None else changes
    try:
        raw = with_new_names(raw)
    except SettingsError as error:
        raise SettingsError(f"{path}: {error}") from None
    raw = laid_over(raw, overrides)
    try:
        settings = Settings.model_validate(raw)
        for number in settings.recipes:
            for_recipe(settings, number)
        check_view(settings, settings.camera.size_px)
    except (ValidationError, SettingsError) as error:
        text = _message(error) if isinstance(error, ValidationError) else str(error)
        if changes is not None:
            raise SettingsError(text) from None
        name = path_of(path).name
        also = f" (with the changes made at the station: {name}; delete it to undo them)" if overrides else ""
        raise SettingsError(f"{path}{also}: {text}") from None
    return _anchored(settings, path.resolve().parent)


def _message(error: ValidationError) -> str:
    def line(details: ErrorDetails) -> str:
        section, *keys = details["loc"] or ("",)
        if section == "camera":
            keys = keys[1:]  # the first is the camera's kind
        place = ".".join(map(str, (section, *keys)))
        return f"{place}: {details['msg'].removeprefix('Value error, ')}"

    return "; ".join(map(line, error.errors()))


def _under(folder: Path, values: dict[str, Any]) -> dict[str, Path]:
    """Return the paths among the values of a section, resolved against the folder."""
    paths = {
        key: value for key, value in values.items() if key in ("path", "folder") or key.endswith("_path")
    }
    return {key: folder / value for key, value in paths.items() if value is not None}


def _anchored(settings: Settings, folder: Path) -> Settings:
    model = settings.model
    changes: dict[str, Any] = {
        "model": model.model_copy(update=_under(folder, dict(model))),
        "recipes": {
            number: recipe.model_copy(update={"model": {**recipe.model, **_under(folder, recipe.model)}})
            for number, recipe in settings.recipes.items()
        },
        "archive": settings.archive.model_copy(update=_under(folder, dict(settings.archive))),
        "channel": settings.channel.model_copy(update=_under(folder, dict(settings.channel))),
        "camera": settings.camera.model_copy(update=_under(folder, dict(settings.camera))),
    }
    tls = settings.plc.tls
    if tls is not None:
        anchored = tls.model_copy(update=_under(folder, dict(tls)))
        changes["plc"] = settings.plc.model_copy(update={"tls": anchored})
    return settings.model_copy(update=changes)

"""Folder of the keys of an installation, next to its settings file; for the account of the engine alone."""

from pathlib import Path


def keys_folder(settings: Path) -> Path:
    """Return the folder of the keys of a settings file: station.keys for station.toml."""
    return settings.with_suffix(".keys")

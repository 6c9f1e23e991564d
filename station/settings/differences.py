"""Names the values in which two settings differ, and which of them only a restart takes up."""

from collections.abc import Iterator, Mapping
from typing import Any

from station.settings.model import Settings

AT_START = (
    "plc",
    "archive",
    "channel",
    "golden",
    "camera.reconnect_s",
    "model.self_test_s",
    "model.self_test_age_s",
)
"""Sections and keys that the engine reads only when it starts."""


def differences(before: Settings, after: Settings) -> list[str]:
    """Return the dotted names of all values that differ, in the order of the sections."""
    old, new = dict(_leaves(before.model_dump())), dict(_leaves(after.model_dump()))
    return [name for name in {**old, **new} if name not in old or name not in new or old[name] != new[name]]


def need_restart(before: Settings, after: Settings) -> list[str]:
    """Return the dotted names of the values that differ and that only a restart takes up."""
    return [
        name
        for name in differences(before, after)
        if any(name == fixed or name.startswith(f"{fixed}.") for fixed in AT_START)
    ]


def _leaves(values: Mapping[Any, Any], place: str = "") -> Iterator[tuple[str, object]]:
    for key, value in values.items():
        name = f"{place}{key}"
        if isinstance(value, Mapping):
            yield from _leaves(value, f"{name}.")
        else:
            yield name, value

"""A change of settings at the station: in the journal with its reason first, then in the file, then the engine is told."""

from collections.abc import Mapping
from typing import Any

from station import adjustments
from station.archive.journal import Kind, append
from station.errors import SettingsError
from station.panel.session import Session
from station.settings_file import load

MIN_REASON = 5
"""Characters of a reason."""


def change(session: Session, place: tuple[str, ...], values: Mapping[str, tuple[object, object]], reason: str) -> bool:
    """Values (before, after) of keys below `place`. Whether the engine could be told.

    Raises SettingsError, RecordError; then nothing was changed.
    """
    if session.user is None or len(reason.strip()) < MIN_REASON:
        raise SettingsError("a login and a reason are needed")
    before = adjustments.read(session.path)
    changes: dict[str, Any] = dict(before)
    level = changes
    for name in place:
        level[name] = dict(level.get(name, {}))
        level = level[name]
    level.update({key: after for key, (_, after) in values.items()})
    for key, (old, new) in values.items():
        append(session.folder, Kind.SETTING, session.user.name, ".".join((*place, key)), _said(old), _said(new), reason.strip())
    adjustments.write(session.path, changes)
    try:
        session.settings = load(session.path)
    except SettingsError:
        adjustments.write(session.path, before)
        raise
    user = session.user.name

    def undo() -> None:
        """The station refused them, for its self-test or a file: at its next start it would not come up."""
        adjustments.write(session.path, before)
        session.settings = load(session.path)
        for key, (old, new) in values.items():
            append(session.folder, Kind.SETTING, user, ".".join((*place, key)), _said(new), _said(old), "refused by the station")

    return session.reload(undo)


def _said(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)

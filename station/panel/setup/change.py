"""A change of settings at the station: in the journal with its reason first, then in the file, then the engine is told.

What cannot be used is taken back, in file and journal: at its next start the engine would not come up.
"""

import copy
from collections.abc import Mapping
from typing import Any

from station import adjustments
from station.archive.journal import Kind, append
from station.errors import SettingsError
from station.panel.session import Session
from station.settings_file import load

MIN_REASON = 5
"""Characters of a reason."""

Values = Mapping[tuple[str, ...], tuple[object, object]]
"""Before and after of each key, named from the top: ("recipes", "1", "model", "hole_threshold")."""


def change(session: Session, values: Values, reason: str) -> bool:
    """Whether the engine could be told. Raises SettingsError, RecordError; then nothing was changed."""
    if session.user is None or len(reason.strip()) < MIN_REASON:
        raise SettingsError("a login and a reason are needed")
    before, who = adjustments.read(session.path), session.user.name
    changes: dict[str, Any] = copy.deepcopy(before)
    for place, (_, after) in values.items():
        level = changes
        for name in place[:-1]:
            level = level.setdefault(name, {})
        level[place[-1]] = after

    def note(back: bool, why: str) -> None:
        for place, (old, new) in values.items():
            pair = (_said(new), _said(old)) if back else (_said(old), _said(new))
            append(session.folder, Kind.SETTING, who, ".".join(place), *pair, why)

    def undo() -> None:
        adjustments.write(session.path, before)
        session.settings = load(session.path)
        note(True, "refused by the station")

    note(False, reason.strip())
    try:
        adjustments.write(session.path, changes)
        session.settings = load(session.path)
    except SettingsError:
        undo()
        raise
    return session.reload(undo)


def _said(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)

"""A change of settings at the station: in the journal with its reason first, then in the file, then the engine is told.

What cannot be used is taken back, in file and journal: at its next start the engine would not come up.
"""

from collections.abc import Mapping

from station import adjustments
from station.archive.journal import Kind
from station.archive.journal_writer import append
from station.errors import SettingsError
from station.panel.session import Session
from station.settings_file import load
from station.users import Level

MIN_REASON = 5
"""Characters of a reason."""

Values = Mapping[tuple[str, ...], tuple[object, object]]
"""Before and after of each key, named from the top: ("recipes", "1", "model", "hole_threshold")."""


def change(session: Session, level: Level, values: Values, reason: str) -> bool:
    """Whether the engine could be told. Raises LoginError below `level`, SettingsError, RecordError; then nothing was changed."""
    who = session.who(level).name
    if len(reason.strip()) < MIN_REASON:
        raise SettingsError("a reason is needed")

    def note(back: bool, why: str) -> None:
        for place, (old, new) in values.items():
            pair = (_said(new), _said(old)) if back else (_said(old), _said(new))
            append(session.folder, Kind.SETTING, who, ".".join(place), *pair, why)

    with adjustments.editing(session.path):
        before = adjustments.read(session.path)
        note(False, reason.strip())
        try:
            _put(session, {place: new for place, (_, new) in values.items()})
        except SettingsError:
            _put(session, {place: adjustments.at(before, place) for place in values})
            note(True, "refused by the station")
            raise

    def undo() -> None:
        with adjustments.editing(session.path):
            _put(session, {place: adjustments.at(before, place) for place in values})
            note(True, "refused by the station")

    return session.reload(undo)


def _put(session: Session, values: Mapping[tuple[str, ...], object]) -> None:
    """Write values over those of the file; None takes one out."""
    changes = adjustments.read(session.path)
    for place, value in values.items():
        changes = adjustments.put(changes, place, value)
    adjustments.write(session.path, changes)
    session.settings = load(session.path)


def _said(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)

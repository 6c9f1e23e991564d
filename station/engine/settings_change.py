"""Changes settings of the station as one transaction of the engine: all of it happens, or nothing.

The steps are: the change is noted in the journal; the new settings are loaded as a start would load them;
their file is written under a temporary name; at a moment without a part in progress it replaces the old one
and becomes active. If the engine ends on the way, the file is the old or the new one; a start accepts both.
"""

import json
import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from station.channel.requests import FAULT, MIN_REASON, Changed
from station.engine.active_settings import ActiveSettings
from station.engine.orders import Order, Reload, UseSettings
from station.errors import RecordError, SettingsError, WeldgateError
from station.files.durable import stage, sync_folder
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.settings import adjustments
from station.settings.differences import differences
from station.settings.file import load
from station.settings.model import Settings, for_recipe

log = logging.getLogger("weldgate.settings")

PATIENCE_S = 60.0
"""Time within which a moment without a part in progress must come."""
ENTRIES_READ = 500
"""Number of newest journal entries that are compared with the file at the start."""
NO_MOMENT = "there was no pause between parts: nothing was changed. Try again."
"""Refusal of a change that the cycle did not take in time."""
NOT_IN_FILE = "not in the settings file at the start"
"""Reason in the journal for a change that the file lacks."""
DIFFERENT_IN_FILE = "the settings file had another value at the start"
"""Reason in the journal for a change that the file has with another value."""


class SettingsChange:
    """Makes changes one at a time. Use from one thread, which waits for the cycle."""

    def __init__(
        self,
        path: Path,
        active: ActiveSettings,
        *,
        hand_over: Callable[[Order], None],
        recipe: Callable[[], int],
        stop: threading.Event,
    ) -> None:
        """`path`: path of the settings file; `recipe` returns the active number; `stop` ends all waiting."""
        self._path, self._active, self._hand_over = path, active, hand_over
        self._recipe, self._stop = recipe, stop

    @property
    def _folder(self) -> Path:
        return self._active.settings.archive.folder

    def make(self, who: str, values: Sequence[Changed], reason: str) -> None:
        """Change settings and return once they are active. Raises WeldgateError if nothing was changed."""
        if len(reason.strip()) < MIN_REASON:
            raise SettingsError("a reason is needed")
        settings, changes = self._active.settings, adjustments.read(self._path)
        self._check_file()
        planned: list[tuple[str, str, str]] = []
        for value in values:
            _check(value)
            planned.append((".".join(value.place), text_before(settings, value), as_text(value.value)))
            changes = adjustments.put(changes, value.place, value.value)
        noted: list[tuple[str, str, str]] = []
        try:
            for subject, old, new in planned:
                append(self._folder, Kind.SETTING, who, subject, before=old, after=new, reason=reason.strip())
                noted.append((subject, old, new))
            self._use(changes)
        except Exception as error:
            why = str(error) if isinstance(error, WeldgateError) else FAULT
            with suppress(RecordError):
                for subject, old, new in noted:
                    append(
                        self._folder,
                        Kind.SETTING,
                        who,
                        subject,
                        before=new,
                        after=old,
                        reason=f"refused: {why}",
                    )
            raise

    def _check_file(self) -> None:
        """Raise SettingsError if the file was edited since it was read: a change would take that over."""
        edited = differences(self._active.settings, load(self._path))
        if edited:
            raise SettingsError(
                f"{', '.join(edited)}: edited in the settings file and not in use yet. Reload settings "
                "first, or restart the station; nothing was changed."
            )

    def _use(self, changes: dict[str, object]) -> None:
        changes = json.loads(json.dumps(changes))  # as a start reads them
        prepared = self._active.prepare(load(self._path, changes), self._recipe())
        temporary, replace_file = stage_changes(self._path, changes)
        try:
            self._carry_out(UseSettings(prepared, replace_file))
        finally:
            with suppress(OSError):
                temporary.unlink(missing_ok=True)

    def reload(self, who: str) -> None:
        """Read the settings file again. Raises WeldgateError if it cannot be used and nothing has changed."""
        append(self._folder, Kind.SETTING, who, "settings file", after="read again")
        self._carry_out(Reload())

    def _carry_out(self, order: UseSettings | Reload) -> None:
        self._hand_over(order)
        refusal = order.ticket.wait(PATIENCE_S, self._stop)
        if refusal is None:
            raise SettingsError(NO_MOMENT)
        if refusal:
            raise SettingsError(refusal)

    def note_unfinished(self) -> None:
        """Note in the journal which of its changes the file lacks: the engine ended while making them.

        Raises RecordError, SettingsError.
        """
        changes, newest = adjustments.read(self._path), set[str]()
        for entry in entries(self._folder, (Kind.SETTING,), limit=ENTRIES_READ):
            place = tuple(entry.subject.split("."))
            if entry.subject in newest or place[0] not in ("camera", "recipes"):
                continue
            newest.add(entry.subject)
            found = adjustments.at(changes, place)
            withdrawn = entry.reason == NOT_IN_FILE or entry.reason.startswith("refused")
            if as_text(found) == entry.after or (found is None and withdrawn):
                continue
            after, why = entry.before, NOT_IN_FILE
            if found is not None:
                after, why = as_text(found), DIFFERENT_IN_FILE
            subject, previous = entry.subject, entry.after
            append(self._folder, Kind.SETTING, "station", subject, before=previous, after=after, reason=why)


def text_before(settings: Settings, value: Changed) -> str:
    """Return the active value of a setting as text; if the model decides it, the value that was shown."""
    found: object = settings.camera
    names = value.place[1:]
    if value.place[0] == "recipes" and value.place[1].isdecimal():
        found, names = for_recipe(settings, int(value.place[1])), value.place[2:]
    for name in names:
        found = found.get(name) if isinstance(found, Mapping) else getattr(found, name, None)
    return as_text(value.shown if found is None else found)


def as_text(value: object) -> str:
    """Return a value as it is written in the journal."""
    if isinstance(value, Mapping):
        return str({int(key): value[key] for key in sorted(value, key=int)})
    return f"{value:g}" if isinstance(value, float) else str(value)


def _check(value: Changed) -> None:
    """Raise SettingsError if the setting cannot be changed at the station."""
    place = value.place
    camera = place[0] == "camera" and len(place) == 2
    limit = len(place) == 6 and place[2:4] == ("model", "limits")
    recipe = place[0] == "recipes" and (len(place) == 4 or limit) and place[2] in adjustments.SECTIONS
    if not (camera or recipe) or place[-1].endswith("path"):
        raise SettingsError(f"{'.'.join(place)}: cannot be changed at the station. Edit the settings file.")


def stage_changes(settings: Path, changes: Mapping[str, object]) -> tuple[Path, Callable[[], None]]:
    """Write changes durably to a temporary file; return its path and the function that puts it in place.

    Raises SettingsError, as does the function.
    """
    path = adjustments.path_of(settings)

    def not_written(error: OSError) -> SettingsError:
        return SettingsError(f"{path}: cannot be written ({error.strerror}); nothing was changed")

    try:
        temporary, target = stage(path, json.dumps(changes, indent=1, sort_keys=True).encode())
    except OSError as error:
        raise not_written(error) from None

    def replace_file() -> None:
        try:
            temporary.replace(target)
        except OSError as error:
            raise not_written(error) from None
        with suppress(OSError):  # the new file is complete and in place either way
            sync_folder(target.parent)

    return temporary, replace_file

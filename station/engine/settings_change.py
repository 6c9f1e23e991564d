"""Changes settings of the station as one transaction of the engine: all of it happens, or nothing.

In this order: the journal says what is about to be changed; the new settings are loaded as a start would load
them; their file is written under a temporary name; with no part in work it replaces the old one and is used.
Whenever the engine ends on the way, the file is the old one or the new one, and a start accepts both.
"""

import json
import logging
import threading
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from station.channel.requests import FAULT, MIN_REASON, Changed
from station.engine.active_settings import Released
from station.engine.orders import Order, Reload, UseSettings
from station.errors import RecordError, SettingsError, WeldgateError
from station.files.durable import stage, sync_folder
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.settings import adjustments
from station.settings.file import load
from station.settings.model import Settings, for_recipe

log = logging.getLogger("weldgate.settings")

PATIENCE_S = 60.0
"""Time within which a moment without a part in work must come."""
LOOKED_AT = 500
"""Entries of the journal, the newest, that are compared with the file at the start."""
NO_MOMENT = "there was no moment without a part in work: nothing was changed"
NOT_IN_FILE = "not in the settings file at the start"
OTHERWISE = "the settings file said otherwise at the start"


class SettingsChange:
    """Makes one change after the other. Use from one thread; it waits for the cycle."""

    def __init__(
        self,
        path: Path,
        released: Released,
        hand_over: Callable[[Order], None],
        recipe: Callable[[], int],
        stop: threading.Event,
    ) -> None:
        """`path`: of the settings file; `recipe` returns the number in use; `stop` ends all waiting."""
        self._path, self._released, self._hand_over = path, released, hand_over
        self._recipe, self._stop = recipe, stop

    @property
    def _folder(self) -> Path:
        return self._released.settings.archive.folder

    def make(self, who: str, values: Sequence[Changed], reason: str) -> None:
        """Change settings and return once they are in use. Raises WeldgateError; then nothing was changed."""
        if len(reason.strip()) < MIN_REASON:
            raise SettingsError("a reason is needed")
        settings, changes = self._released.settings, adjustments.read(self._path)
        words: list[tuple[str, str, str]] = []
        for value in values:
            _check(value)
            words.append((".".join(value.place), before(settings, value), said(value.value)))
            changes = adjustments.put(changes, value.place, value.value)
        noted: list[tuple[str, str, str]] = []
        try:
            for subject, old, new in words:
                append(self._folder, Kind.SETTING, who, subject, old, new, reason.strip())
                noted.append((subject, old, new))
            self._use(changes)
        except Exception as error:
            why = str(error) if isinstance(error, WeldgateError) else FAULT
            with suppress(RecordError):
                for subject, old, new in noted:
                    append(self._folder, Kind.SETTING, who, subject, new, old, f"refused: {why}")
            raise

    def _use(self, changes: dict[str, object]) -> None:
        changes = json.loads(json.dumps(changes))  # as a start reads them
        change = self._released.prepared(load(self._path, changes), self._recipe())
        part, replace_file = staged(self._path, changes)
        order = UseSettings(change, replace_file)
        try:
            self._carried_out(order)
        finally:
            with suppress(OSError):
                part.unlink(missing_ok=True)

    def reload(self, who: str) -> None:
        """Read the settings file again. Raises WeldgateError if it cannot be used; then nothing changes."""
        append(self._folder, Kind.SETTING, who, "settings file", "", "read again")
        self._carried_out(Reload())

    def _carried_out(self, order: UseSettings | Reload) -> None:
        self._hand_over(order)
        refusal = order.ticket.wait(PATIENCE_S, self._stop)
        if refusal is None:
            raise SettingsError(NO_MOMENT)
        if refusal:
            raise SettingsError(refusal)

    def settle(self) -> None:
        """Note which changes the journal tells of are not in the file: the engine ended while it made them.

        Raises RecordError, SettingsError.
        """
        changes, newest = adjustments.read(self._path), set[str]()
        for entry in entries(self._folder, (Kind.SETTING,), limit=LOOKED_AT):
            place = tuple(entry.subject.split("."))
            if entry.subject in newest or place[0] not in ("camera", "recipes"):
                continue
            newest.add(entry.subject)
            found = adjustments.at(changes, place)
            taken_back = entry.reason == NOT_IN_FILE or entry.reason.startswith("refused")
            if said(found) == entry.after or (found is None and taken_back):
                continue
            after, why = (entry.before, NOT_IN_FILE) if found is None else (said(found), OTHERWISE)
            append(self._folder, Kind.SETTING, "station", entry.subject, entry.after, after, why)


def before(settings: Settings, value: Changed) -> str:
    """Return what a setting is in use, in words; what the window showed where the model decides."""
    found: object = settings.camera
    names = value.place[1:]
    if value.place[0] == "recipes" and value.place[1].isdecimal():
        found, names = for_recipe(settings, int(value.place[1])), value.place[2:]
    for name in names:
        found = found.get(name) if isinstance(found, Mapping) else getattr(found, name, None)
    return said(value.shown if found is None else found)


def said(value: object) -> str:
    """Return a value as the journal has it."""
    if isinstance(value, Mapping):
        return str({int(key): value[key] for key in sorted(value, key=int)})
    return f"{value:g}" if isinstance(value, float) else str(value)


def _check(value: Changed) -> None:
    """Raise SettingsError if that place is not one that can be changed at the station."""
    place = value.place
    camera = place[0] == "camera" and len(place) == 2
    limit = len(place) == 6 and place[2:4] == ("model", "limits")
    recipe = place[0] == "recipes" and (len(place) == 4 or limit) and place[2] in adjustments.SECTIONS
    if not (camera or recipe) or place[-1].endswith("path"):
        raise SettingsError(f"{'.'.join(place)}: cannot be changed at the station. Edit the settings file.")


def staged(settings: Path, changes: Mapping[str, object]) -> tuple[Path, Callable[[], None]]:
    """Write changes durably under a temporary name. Return it, and what puts them in place.

    Raises SettingsError, as does what is returned.
    """
    path = adjustments.path_of(settings)

    def unwritten(error: OSError) -> SettingsError:
        return SettingsError(f"{path}: cannot be written ({error.strerror}); nothing was changed")

    try:
        part = stage(path, json.dumps(changes, indent=1, sort_keys=True).encode())
    except OSError as error:
        raise unwritten(error) from None

    def replace_file() -> None:
        try:
            part.replace(path)
        except OSError as error:
            raise unwritten(error) from None
        with suppress(OSError):  # the new file is whole and in its place: used either way
            sync_folder(path.parent)

    return part, replace_file

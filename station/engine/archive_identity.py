"""Knows the archive of this station: an empty folder is never taken for it, as when a disk is missing.

The archive holds a marker; a small file next to the settings says which marker it must be.
"""

import json
import secrets
from pathlib import Path

from station.archive.schema import NAME as INDEX
from station.errors import RecordError
from station.files.durable import sync_folder, write_whole
from station.files.regular import read_regular

MARKER = "archive.id"
"""Name of the file in the archive."""
MAX_BYTES = 1000


def note_of(settings: Path) -> Path:
    """Return the path of the note about the archive: station.archive.json for station.toml."""
    return settings.with_suffix(".archive.json")


def check_archive(settings: Path, folder: Path) -> None:
    """Raise RecordError unless the folder is the archive of this station, or the station has none yet."""
    expected = _noted(settings)
    if expected is None:
        return
    found = _marker(folder)
    if found == expected and (folder / INDEX).exists():
        return
    what = "is missing or empty" if found is None else "is another one"
    if found == expected:
        what = f"has no {INDEX}"
    raise RecordError(
        f"{folder}: the archive of this station {what}. Mount its disk or restore it; if a new archive is "
        f"meant to begin here, run: weldgate new-archive -c {settings}"
    )


def note_archive(settings: Path, folder: Path) -> None:
    """Mark the archive, which is open, and note it if the station has none yet. Raises RecordError."""
    if _noted(settings) is not None:
        return
    marker = _marker(folder)
    try:
        if marker is None:
            marker = secrets.token_hex(16)
            write_whole(folder / MARKER, f"{marker}\n".encode(), durable=True)
            sync_folder(folder)
        write_whole(note_of(settings), json.dumps({"archive": marker}).encode(), durable=True)
        sync_folder(note_of(settings).parent)
    except OSError as error:
        raise RecordError(
            f"{error.filename or folder}: the archive cannot be noted ({error.strerror}); "
            "let the engine write there"
        ) from None


def forget_archive(settings: Path) -> Path | None:
    """Move the note aside: the next start takes the folder as it is. Return its new path, None without one.

    Raises RecordError.
    """
    note = note_of(settings)
    number = 1
    while (aside := note.with_name(f"{note.name}.{number}")).exists():
        number += 1
    try:
        note.rename(aside)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise RecordError(f"{note}: cannot be moved aside ({error.strerror})") from None
    return aside


def _noted(settings: Path) -> str | None:
    note = note_of(settings)
    try:
        noted = json.loads(read_regular(note, MAX_BYTES))["archive"]
    except FileNotFoundError:
        return None
    except (OSError, ValueError, KeyError, TypeError):
        noted = None
    if not isinstance(noted, str):
        raise RecordError(f"{note}: cannot be read; restore it, or run: weldgate new-archive -c {settings}")
    return noted


def _marker(folder: Path) -> str | None:
    try:
        return read_regular(folder / MARKER, MAX_BYTES).decode().strip() or None
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise RecordError(f"{folder / MARKER}: cannot be read ({error})") from None

"""Moves aside what an interrupted part or a restored index left behind in the archive; removes nothing."""

import logging
import os
from collections.abc import Iterator
from pathlib import Path

from station.errors import RecordError
from station.files.durable import sync_folder

log = logging.getLogger("weldgate.archive")

ASIDE = "aside"
"""Folder in the archive of what was moved aside."""


def move_aside(folder: Path, path: Path) -> None:
    """Move a file of the archive to the folder `aside`, under a name that is free there. Raises OSError."""
    aside = folder / ASIDE
    aside.mkdir(exist_ok=True)
    name = path.name if path.parent == folder else f"{path.parent.name}-{path.name}"
    number, target = 1, aside / name
    while target.exists():
        number, target = number + 1, aside / f"{name}.{number}"
    path.rename(target)
    sync_folder(aside)
    sync_folder(path.parent)
    log.warning("%s was left behind without an entry in the index: moved to %s", path, target)


def numbered_files(folder: Path) -> Iterator[tuple[int, str]]:
    """Yield number and path of all frames and records; the clock may have been wrong, so all days count."""
    for day in folder.glob("????-??-??"):
        if not day.is_dir():
            continue
        with os.scandir(day) as entries:
            for entry in entries:
                stem, _, suffix = entry.name.partition(".")
                if suffix in ("json", "png") and stem.isdecimal() and stem.isascii():
                    yield int(stem), entry.path


def clear_the_way(folder: Path, following: int) -> None:
    """Move aside what an interrupted part left behind under the number of the next record.

    Raises RecordError if the index is older than the files, whose numbers would be used again, and OSError.
    """
    last, left = 0, list[str]()
    for number, path in numbered_files(folder):
        last = max(last, number)
        if number == following:
            left.append(path)
    if last > following:  # the next one may be left over from an interrupted part
        raise RecordError(
            f"{folder}: has record {last}, but its index ends at {following - 1}; "
            "restore index.sqlite, or set another archive.folder"
        )
    for path in sorted(left):
        move_aside(folder, Path(path))

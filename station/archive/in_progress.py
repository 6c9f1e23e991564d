"""Remembers on disk which part is being inspected, so that it gets its record even if the engine ends.

The file survives the end of the process, however it ends; only `Archive` uses it.
"""

from dataclasses import dataclass
from pathlib import Path

from pydantic import TypeAdapter

from station.files.regular import read_regular
from station.records import Part

NAME = "in_progress.json"
"""Name of the file in the archive."""
MAX_BYTES = 10_000


@dataclass(frozen=True, slots=True)
class InProgress:
    """A part that is being inspected, and the number that its record will have."""

    part: Part
    inspection_id: int


_ADAPTER = TypeAdapter(InProgress)


def announce(folder: Path, in_progress: InProgress) -> None:
    """Write the file; it is whole or absent. Raises OSError."""
    part = folder / f"{NAME}.part"
    part.write_bytes(_ADAPTER.dump_json(in_progress))
    part.replace(folder / NAME)


def announced(folder: Path) -> InProgress | None:
    """Return what the file says; None if there is none, or none that can be read."""
    try:
        return _ADAPTER.validate_json(read_regular(folder / NAME, MAX_BYTES), strict=True)
    except (OSError, ValueError):
        return None


def done(folder: Path) -> None:
    """Remove the file. Raises OSError."""
    (folder / NAME).unlink(missing_ok=True)

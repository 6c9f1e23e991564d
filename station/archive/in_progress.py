"""Remembers on disk which parts are being inspected, so that they get their records if the engine ends.

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
    """Parts that are being inspected or wait for it, and the number of the record of the first."""

    parts: tuple[Part, ...]
    inspection_id: int

    def unrecorded(self, following: int) -> tuple[Part, ...]:
        """Return the parts without a record, if the next record will have the number `following`."""
        return self.parts[max(following - self.inspection_id, 0) :]


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


def done(folder: Path, following: int) -> None:
    """Remove the file unless it names a part without a record; `following`: number of the next record.

    Raises OSError.
    """
    found = announced(folder)
    if found is not None and not found.unrecorded(following):
        (folder / NAME).unlink()

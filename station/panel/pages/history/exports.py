"""Writes found or reviewed parts into files next to the window; knows nothing of Qt."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from station.analysis.export import export
from station.archive.reader import Listed, Query, read_records
from station.files.durable import replacing
from station.journal.reviews import reviews
from station.panel.widgets.progress import Progress


@dataclass(frozen=True, slots=True)
class Written:
    """What an export has written."""

    target: Path
    parts: int
    """Number of parts that were written."""
    left_out: int
    """Number of parts that could not be written."""


def write_table(folder: Path, numbers: Sequence[int], target: Path, progress: Progress) -> Written | None:
    """Write the parts of these numbers as a CSV file, one row each; replace a file that exists.

    `folder` is the archive. Return None if cancelled. Raises RecordError, OSError.
    """
    entries = _read(folder, numbers, progress)
    if entries is None:
        return None
    with replacing(target) as file:
        problems = list(export(entries, folder, file, "csv"))
    return Written(target, len(entries) - len(problems), len(problems))


def write_reviewed(folder: Path, target: Path, progress: Progress) -> Written | None:
    """Write the crops of the parts that two people agree on into a new folder.

    `folder` is the archive. Return None if cancelled while reading. Raises RecordError, OSError.
    """
    agreed = [number for number, review in reviews(folder).items() if review.agreed is not None]
    entries = _read(folder, agreed, progress)
    if entries is None:
        return None
    counts, total = iter(range(len(entries))), len(entries)
    problems = list(
        export(entries, folder, target, "reviewed", keep_going=lambda: progress(next(counts, 0), total))
    )
    return Written(target, total - len(problems), len(problems))


def _read(folder: Path, numbers: Sequence[int], progress: Progress) -> list[Listed] | None:
    """Return the records of these numbers, or None if cancelled."""
    entries: list[Listed] = []
    for count, number in enumerate(numbers):
        if not progress(count, len(numbers)):
            return None
        entries += read_records(folder, Query(number=number))
    return entries

"""Writes what a person says of a verdict afterwards: for the engine alone."""

from collections.abc import Mapping
from pathlib import Path

from station.defects import Reason
from station.errors import LoginError
from station.journal.journal import Kind
from station.journal.journal_writer import append
from station.journal.reviews import Opinion, possible, reviews


def give(
    folder: Path,
    who: str,
    *,
    may_second: bool,
    inspection_id: int,
    verdict: str,
    opinion: Opinion,
    comment: str = "",
    marks: Mapping[int, Reason] | None = None,
) -> None:
    """Note a review. Raises ValueError if it does not fit the verdict, LoginError, RecordError.

    `may_second`: whether this person's level allows a second review; `marks`: where a defect was missed.
    """
    if opinion not in possible(verdict) or (marks and opinion is not Opinion.MISSED):
        raise ValueError(f"{opinion} cannot be said of {verdict}")
    before = reviews(folder).get(inspection_id)
    if not may_second and before is not None and set(before.opinions) - {who}:
        raise LoginError("the second review needs the level quality")
    where = ", ".join(f"{number} {kind}" for number, kind in sorted((marks or {}).items()))
    append(
        folder,
        Kind.REVIEW,
        who,
        str(inspection_id),
        verdict,
        f"{opinion}: {where}" if where else opinion,
        comment,
    )

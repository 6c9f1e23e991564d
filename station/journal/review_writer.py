"""Writes reviews of verdicts; used by the engine only."""

from collections.abc import Mapping
from pathlib import Path

from station.defects import Reason
from station.errors import LoginError
from station.journal.journal import Kind
from station.journal.journal_writer import append
from station.journal.reviews import Opinion, possible, reviews


def save_review(
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
    """Save a review. Raises ValueError if it does not fit the verdict, LoginError, RecordError.

    `may_second`: this user's level allows a second review; `marks`: missed defect kind by segment.
    """
    if opinion not in possible(verdict) or (marks and opinion is not Opinion.MISSED):
        raise ValueError(f"the opinion '{opinion}' does not fit the verdict {verdict}")
    previous = reviews(folder).get(inspection_id)
    if not may_second and previous is not None and set(previous.opinions) - {who}:
        raise LoginError("the second review needs the level quality")
    where = ", ".join(f"{number} {kind}" for number, kind in sorted((marks or {}).items()))
    append(
        folder,
        Kind.REVIEW,
        who,
        str(inspection_id),
        before=verdict,
        after=f"{opinion}: {where}" if where else opinion,
        reason=comment,
    )

"""A search among the recorded parts; pure."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

from station.archive.reader import Query, Row, find
from station.domain import Purpose, Verdict
from station.journal.reviews import Review, State, reviews

FOUND = 300
"""Maximum number of parts that are shown, the newest."""
SEARCHED = 5000
"""Maximum number of parts, the newest, whose reviews are searched."""
MIN_SCORE = 0.05
"""Minimum score for a search by segment without a score: lower scores are not in the index."""
TO_CONFIRM = "to be confirmed"
"""Choice of the NOK parts on which two people do not agree yet."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Search:
    """Conditions that the found parts meet; None stands for any."""

    serial: str = ""
    """Serial, or a prefix followed by *."""
    hours: float | None = None
    """Length of the time up to now in which the part was grabbed."""
    since: datetime | None = None
    until: datetime | None = None
    """Times between which the part was grabbed, instead of `hours`."""
    verdict: str | None = None
    reason: str | None = None
    segment: int | None = None
    score: float | None = None
    """Minimum score of NOK, of the segment or of the worst one."""
    state: str | None = None
    """State of the review, or `TO_CONFIRM`."""

    def query(self, now: datetime) -> Query:
        """Return the query for the archive's index, which does not have the state of the reviews."""
        return Query(
            serial=self.serial.strip() or None,
            since=self.since if self.hours is None else now - timedelta(hours=self.hours),
            until=self.until if self.hours is None else None,
            verdict=self.verdict,
            reason=self.reason,
            segment=self.segment,
            min_score=MIN_SCORE if self.segment is not None and self.score is None else self.score,
            newest_first=True,
            limit=FOUND if self.state is None else SEARCHED,
        )

    def fits(self, row: Row, review: Review | None) -> bool:
        """Return whether the review of a part has the state that is searched for."""
        current = State.NONE if review is None else review.state
        if self.state == TO_CONFIRM:
            return row.verdict == Verdict.NOK and row.purpose == Purpose.PART and current is not State.AGREED
        return self.state is None or current == self.state

    def run(self, folder: Path, now: datetime) -> tuple[list[Row], dict[int, Review]]:
        """Return the newest parts that match, and all reviews. Raises RecordError."""
        known = reviews(folder)
        rows = find(folder, self.query(now))
        return [row for row in rows if self.fits(row, known.get(row.inspection_id))][:FOUND], known

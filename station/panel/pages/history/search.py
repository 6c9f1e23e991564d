"""What is looked for among the past parts; pure."""

from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import Path

from station.archive.reader import Row, Wanted, find
from station.domain import Purpose, Verdict
from station.journal.reviews import Review, State, reviews

FOUND = 300
"""Parts that are shown at most, the newest."""
SEARCHED = 5000
"""Parts that are looked at, the newest, when the state of their reviews is asked for."""
MIN_SCORE = 0.05
"""Least score by which a segment is looked for, if none is named: lower ones are not in the index."""
TO_CONFIRM = "to be confirmed"


@dataclass(frozen=True, slots=True)
class Search:
    """One question to the archive; None: anything."""

    serial: str = ""
    """A serial, or a prefix that ends in *."""
    hours: float | None = None
    """Parts of the last so many hours."""
    since: datetime | None = None
    until: datetime | None = None
    """Parts between two times, instead of `hours`."""
    verdict: str | None = None
    reason: str | None = None
    segment: int | None = None
    score: float | None = None
    """Score of NOK, at least: of the segment, or of the worst."""
    state: str | None = None
    """State of the review, or `TO_CONFIRM`."""

    def wanted(self, now: datetime) -> Wanted:
        """Return what the archive is asked for; the state of the reviews is not in its index."""
        return Wanted(
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
        """Return whether a part is in the state of review that is asked for.

        A part is to be confirmed if it was judged NOK and two people do not agree on it yet.
        """
        now = State.NONE if review is None else review.state
        if self.state == TO_CONFIRM:
            return row.verdict == Verdict.NOK and row.purpose == Purpose.PART and now is not State.AGREED
        return self.state is None or now == self.state

    def run(self, folder: Path, now: datetime) -> tuple[list[Row], dict[int, Review]]:
        """Return the newest parts that fit, and all reviews. Raises RecordError."""
        known = reviews(folder)
        rows = find(folder, self.wanted(now))
        return [row for row in rows if self.fits(row, known.get(row.inspection_id))][:FOUND], known

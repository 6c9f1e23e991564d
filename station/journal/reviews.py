"""Reviews of verdicts; they never change a verdict, and an opinion counts once two people share it."""

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from station.defects import Reason
from station.errors import RecordError
from station.journal.journal import NAME, Kind, entries


class Opinion(StrEnum):
    """Opinion on one verdict."""

    RIGHT = "right"
    FALSE_CALL = "false call"
    """The part is OK, but was judged NOK."""
    MISSED = "missed defect"
    """The part is NOK, but was judged OK."""


class State(StrEnum):
    """State of the review of one part."""

    NONE = "not reviewed"
    ONE = "reviewed once"
    AGREED = "two agree"
    DISPUTED = "disputed"


Marks = dict[int, Reason]
"""Missed defect kind by segment number."""


@dataclass(frozen=True, slots=True)
class Review:
    """Opinions on one part, the last one of each person, by name."""

    opinions: dict[str, Opinion]
    marks: dict[str, Marks] = field(default_factory=dict)
    """Missed defects by name of the person."""

    @property
    def state(self) -> State:
        """State of the review; agreed if at least two people share one opinion and none has another."""
        if not self.opinions:
            return State.NONE
        if len(set(self.opinions.values())) > 1:
            return State.DISPUTED
        return State.AGREED if len(self.opinions) > 1 else State.ONE

    @property
    def agreed(self) -> Opinion | None:
        """Opinion on which people agree; None if they do not."""
        return next(iter(self.opinions.values())) if self.state is State.AGREED else None

    @property
    def agreed_marks(self) -> Marks:
        """Missed defects on which all of them agree."""
        if self.agreed is not Opinion.MISSED:
            return {}
        first, *others = (self.marks.get(who, {}) for who in self.opinions)
        return {
            number: kind
            for number, kind in first.items()
            if all(other.get(number) is kind for other in others)
        }


def possible(verdict: str) -> tuple[Opinion, ...]:
    """Return the opinions that fit a verdict; none for a part that was not judged."""
    fitting = {"OK": (Opinion.RIGHT, Opinion.MISSED), "NOK": (Opinion.RIGHT, Opinion.FALSE_CALL)}
    return fitting.get(verdict, ())


def reviews(folder: Path) -> dict[int, Review]:
    """Return the reviews of all reviewed parts by inspection id. Raises RecordError."""
    found: dict[int, Review] = {}
    for entry in entries(folder, (Kind.REVIEW,), newest_first=False):
        opinion, _, where = entry.after.partition(": ")
        try:
            review = found.setdefault(int(entry.subject), Review({}))
            review.opinions[entry.who] = Opinion(opinion)
            pairs = (mark.split(" ", 1) for mark in where.split(", ") if mark)
            review.marks[entry.who] = {int(number): Reason(kind) for number, kind in pairs}
        except ValueError:
            raise RecordError(
                f"{folder / NAME}: entry {entry.number} is not a review; it is damaged"
            ) from None
    return found

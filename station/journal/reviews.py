"""What people say of verdicts afterwards. The verdict itself is never changed; an opinion counts once two people share it."""

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from station.defects import Reason
from station.journal.journal import Kind, entries


class Opinion(StrEnum):
    """Of one verdict."""

    RIGHT = "right"
    FALSE_CALL = "false call"
    """The part is OK, but was judged NOK."""
    MISSED = "missed defect"
    """The part is NOK, but was judged OK."""


class State(StrEnum):
    """How far a review is."""

    NONE = "not reviewed"
    ONE = "reviewed once"
    AGREED = "two agree"
    DISPUTED = "disputed"


Marks = dict[int, Reason]
"""Kind of the defect that was missed in a segment, by its number."""


@dataclass(frozen=True, slots=True)
class Review:
    """All opinions of one part: the last of each person."""

    opinions: dict[str, Opinion]
    marks: dict[str, Marks] = field(default_factory=dict)
    """Where they say that a defect was missed."""

    @property
    def state(self) -> State:
        """Two people must say the same, and nobody otherwise."""
        if not self.opinions:
            return State.NONE
        if len(set(self.opinions.values())) > 1:
            return State.DISPUTED
        return State.AGREED if len(self.opinions) > 1 else State.ONE

    @property
    def agreed(self) -> Opinion | None:
        """What two people say."""
        return next(iter(self.opinions.values())) if self.state is State.AGREED else None

    @property
    def agreed_marks(self) -> Marks:
        """What all of them see in the same segment."""
        if self.agreed is not Opinion.MISSED:
            return {}
        first, *others = (self.marks.get(who, {}) for who in self.opinions)
        return {
            number: kind
            for number, kind in first.items()
            if all(other.get(number) is kind for other in others)
        }


def possible(verdict: str) -> tuple[Opinion, ...]:
    """Opinions that one can have of a verdict; none of a part that was not judged."""
    return {"OK": (Opinion.RIGHT, Opinion.MISSED), "NOK": (Opinion.RIGHT, Opinion.FALSE_CALL)}.get(
        verdict, ()
    )


def reviews(folder: Path) -> dict[int, Review]:
    """All reviewed parts. Raises RecordError."""
    found: dict[int, Review] = {}
    for entry in entries(folder, (Kind.REVIEW,), newest_first=False):
        opinion, _, where = entry.after.partition(": ")
        review = found.setdefault(int(entry.subject), Review({}))
        review.opinions[entry.who] = Opinion(opinion)
        pairs = (mark.split(" ", 1) for mark in where.split(", ") if mark)
        review.marks[entry.who] = {int(number): Reason(kind) for number, kind in pairs}
    return found

"""What people say of verdicts afterwards. The verdict itself is never changed; an opinion counts once two people share it."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from station.archive.journal import Kind, append, entries
from station.errors import LoginError


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


@dataclass(frozen=True, slots=True)
class Review:
    """All opinions of one part: the last of each person."""

    opinions: dict[str, Opinion]

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


def possible(verdict: str) -> tuple[Opinion, ...]:
    """Opinions that one can have of a verdict; none of a part that was not judged."""
    return {"OK": (Opinion.RIGHT, Opinion.MISSED), "NOK": (Opinion.RIGHT, Opinion.FALSE_CALL)}.get(verdict, ())


def give(folder: Path, who: str, may_second: bool, inspection_id: int, verdict: str, opinion: Opinion, comment: str = "") -> None:
    """`may_second`: whether a second person of their level is believed; raises LoginError if it is needed, RecordError.

    Raises ValueError if one cannot think so of that verdict.
    """
    if opinion not in possible(verdict):
        raise ValueError(f"{opinion} cannot be said of {verdict}")
    before = reviews(folder).get(inspection_id)
    if not may_second and before is not None and set(before.opinions) - {who}:
        raise LoginError("the second review needs the level quality")
    append(folder, Kind.REVIEW, who, str(inspection_id), verdict, opinion, comment)


def reviews(folder: Path) -> dict[int, Review]:
    """All reviewed parts. Raises RecordError."""
    found: dict[int, dict[str, Opinion]] = {}
    for entry in entries(folder, (Kind.REVIEW,), newest_first=False):
        found.setdefault(int(entry.subject), {})[entry.who] = Opinion(entry.after)
    return {number: Review(opinions) for number, opinions in found.items()}

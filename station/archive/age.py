"""Tells how old records are: by their order and their neighbours, never by a date that jumped.

Records are numbered in the order in which they were made. Where the date of a record lies before that of its
predecessor, or long after it, a clock may have been wrong: a person must say which side is right. Records
with a wrong date count as made just before the next record with a right one.
"""

import sqlite3
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from enum import StrEnum

BACK = timedelta(hours=1)
"""Time by which a date may lie before that of the previous record: clocks are corrected by seconds."""
PAUSE = timedelta(days=31)
"""Longest pause between two records; what is longer is a jump until a person says that it was a pause."""
STRANGE = timedelta(days=7)
"""Age of the newest record above which nothing is deleted for its age: the clock may be wrong."""
END = 1 << 62
"""Number after that of every record."""


class Right(StrEnum):
    """Answer of a person to the question which dates at a jump are right."""

    BEFORE = "before"
    """The dates before the jump are right; those after it are wrong, up to the next jump."""
    AFTER = "after"
    """The dates after the jump are right; those before it are wrong, back to the previous jump."""
    BOTH = "both"
    """All dates are right: the line paused."""


@dataclass(frozen=True, slots=True)
class Clock:
    """What people and the running engine know about the clock."""

    decisions: Mapping[int, Right] = field(default_factory=dict)
    """Answers by the number of the first record after a jump."""
    steps: Collection[int] = ()
    """Numbers of the first records after a jump that the engine saw while it was running."""


@dataclass(frozen=True, slots=True)
class Jump:
    """A jump of the dates between two neighbours."""

    number: int
    """Number of the first record after the jump."""
    before: str
    """Date of the record before it, UTC, ISO 8601."""
    after: str
    """Date of the first record after it."""

    def __str__(self) -> str:
        return f"record {self.number}: from {self.before[:19]} to {self.after[:19]}"


def jumps(index: sqlite3.Connection, clock: Clock) -> list[Jump]:
    """Return the jumps among the dates of the records in an index, by number. Raises sqlite3.Error."""
    steps = ", ".join(str(int(number)) for number in clock.steps)
    rows = index.execute(
        "WITH dated AS (SELECT inspection_id, grabbed_at, julianday(grabbed_at) AS day, "
        "LAG(grabbed_at) OVER (ORDER BY inspection_id) AS earlier FROM records) "
        "SELECT inspection_id, earlier, grabbed_at FROM dated WHERE earlier IS NOT NULL AND (day IS NULL "
        f"OR day < julianday(earlier) - {BACK / timedelta(days=1)} "
        f"OR day > julianday(earlier) + {PAUSE / timedelta(days=1)} "
        f"OR inspection_id IN ({steps})) ORDER BY inspection_id"
    )
    return [Jump(int(row[0]), str(row[1]), str(row[2])) for row in rows]


def undecided(found: Collection[Jump], clock: Clock) -> list[Jump]:
    """Return the jumps of which no person has said which side is right."""
    return [jump for jump in found if jump.number not in clock.decisions]


def trusted(found: Collection[Jump], clock: Clock) -> str:
    """Return the SQL condition of the records whose dates are right."""
    starts = [0, *(jump.number for jump in found)]
    wrong = set()
    for place, jump in enumerate(found):
        decision = clock.decisions.get(jump.number)
        if decision is Right.BEFORE:
            wrong.add(place + 1)
        elif decision is Right.AFTER:
            wrong.add(place)
    runs = zip(starts, [*starts[1:], END], strict=True)
    chosen = [
        f"(inspection_id >= {first} AND inspection_id < {end})"
        for place, (first, end) in enumerate(runs)
        if place not in wrong
    ]
    return " OR ".join(chosen) or "0"


def first_young(index: sqlite3.Connection, when: datetime, right: str) -> int:
    """Return the number before which all records are older than `when`; `right`: as from `trusted`.

    A record with a wrong date is old if a later one with a right date is. Raises sqlite3.Error.
    """
    young = index.execute(
        f"SELECT MIN(inspection_id) FROM records WHERE ({right}) AND grabbed_at >= ?", (when.isoformat(),)
    ).fetchone()[0]
    limit = END if young is None else int(young)
    old = index.execute(
        f"SELECT MAX(inspection_id) FROM records WHERE ({right}) AND inspection_id < ?", (limit,)
    ).fetchone()[0]
    return 0 if old is None else int(old) + 1


def newest(index: sqlite3.Connection, right: str) -> datetime | None:
    """Return the date of the newest record whose date is right. Raises sqlite3.Error, ValueError."""
    row = index.execute(
        f"SELECT grabbed_at FROM records WHERE {right} ORDER BY inspection_id DESC LIMIT 1"
    ).fetchone()
    return None if row is None else datetime.fromisoformat(row[0])

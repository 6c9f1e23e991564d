"""When other limits may be saved: after what they would have done was asked, and with a reason; pure."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from station.archive.reader import Wanted, find, read_words
from station.channel.requests import MIN_REASON
from station.records import Record

PARTS = 5000
"""The newest parts that are scored again."""


@dataclass(frozen=True, slots=True)
class Values:
    """Limits of one recipe, as they stand in the fields."""

    recipe: int
    limits: dict[str, float]
    """By key."""
    segments: dict[int, float] = field(default_factory=dict)
    """By number."""

    def rounded(self) -> "Values":
        """Return them as the fields show them."""
        return replace(self, limits={key: float(f"{value:.6g}") for key, value in self.limits.items()})


class Missing(StrEnum):
    """What is still needed before limits can be saved."""

    NOTHING = "nothing"
    CHANGE = "a change"
    LOGIN = "a login"
    QUESTION = "a what-if"
    REASON = "a reason"
    ANSWER = "the engine's answer"


class WhatIfState:
    """Knows the limits in use and those of the what-if that is shown."""

    def __init__(self) -> None:
        self.in_use: Values | None = None
        self.asked: Values | None = None
        """Values of the what-if that is shown."""

    def changed(self, values: Values | None) -> bool:
        """Return whether these are other limits than those in use."""
        return self.in_use is not None and values is not None and values != self.in_use.rounded()

    def missing(self, values: Values | None, reason: str, allowed: bool, waiting: bool) -> Missing:
        """Return what is needed first before these limits can be saved.

        `allowed`: whether who is logged in may; `waiting`: whether the engine makes a change just now.
        """
        if not allowed:
            return Missing.LOGIN
        if not self.changed(values):
            return Missing.CHANGE
        if values != self.asked:
            return Missing.QUESTION
        if len(reason.strip()) < MIN_REASON:
            return Missing.REASON
        return Missing.ANSWER if waiting else Missing.NOTHING


Progress = Callable[[int, int], bool]
"""Called with how much is done of how much; returns False if the work was cancelled."""


def scored_records(
    folder: Path, recipe: int, judge: str, progress: Progress
) -> tuple[list[Record], int] | None:
    """Return the newest records of a recipe that one model has scored, and how many were left out.

    `judge`: hash of the model; scores of another one say nothing. None if it was cancelled. Raises RecordError.
    """
    rows = find(folder, Wanted(recipe=recipe, newest_first=True, limit=PARTS))
    records = list[Record]()
    for count, row in enumerate(rows):
        if count % 20 == 0 and not progress(count, len(rows)):
            return None
        record, _ = read_words(folder, row)
        if record is not None and record.provenance.model_hash == judge:
            records.append(record)
    return records, len(rows) - len(records)

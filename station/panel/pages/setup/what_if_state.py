"""Decides when other limits can be saved: after a what-if and with a reason; pure."""

from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from station.archive.reader import Query, find, read_words
from station.channel.requests import MIN_REASON
from station.panel.widgets.progress import Progress
from station.records import Record

PARTS = 5000
"""Maximum number of the newest parts that are judged with other limits."""


@dataclass(frozen=True, slots=True)
class Values:
    """Limits of one recipe, as the fields show them."""

    recipe: int
    limits: dict[str, float]
    """Values by key, see `limit_fields.FIELDS`."""
    segments: dict[int, float] = field(default_factory=dict)
    """Thresholds of single segments by number."""

    def rounded(self) -> "Values":
        """Return the limits rounded as the fields show them."""
        return replace(self, limits={key: float(f"{value:.6g}") for key, value in self.limits.items()})


class Missing(StrEnum):
    """Condition that must be met before limits can be saved."""

    NOTHING = "nothing"
    CHANGE = "a change"
    LOGIN = "a login"
    QUESTION = "a what-if"
    REASON = "a reason"
    ANSWER = "the engine's answer"


class WhatIfState:
    """Holds the limits in use and those of the what-if that is shown."""

    def __init__(self) -> None:
        self.in_use: Values | None = None
        """Limits in use, or None if they are not yet known."""
        self.asked: Values | None = None
        """Limits of the what-if that is shown, or None."""

    def changed(self, values: Values | None) -> bool:
        """Return whether these limits differ from those in use."""
        return self.in_use is not None and values is not None and values != self.in_use.rounded()

    def missing(self, values: Values | None, reason: str, allowed: bool, waiting: bool) -> Missing:
        """Return the first condition that is not met before these limits can be saved.

        `allowed`: the user has the level for it; `waiting`: the engine is making a change.
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


def scored_records(
    folder: Path, recipe: int, model_hash: str, progress: Progress
) -> tuple[list[Record], int] | None:
    """Return the newest records of a recipe that one model has judged, and how many were left out.

    `model_hash` names the model: scores of others cannot be compared. Return None if cancelled.
    Raises RecordError.
    """
    rows = find(folder, Query(recipe=recipe, newest_first=True, limit=PARTS))
    records = list[Record]()
    for count, row in enumerate(rows):
        if count % 20 == 0 and not progress(count, len(rows)):
            return None
        record, _ = read_words(folder, row)
        if record is not None and record.provenance.model_hash == model_hash:
            records.append(record)
    return records, len(rows) - len(records)

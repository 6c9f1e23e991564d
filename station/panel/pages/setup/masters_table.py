"""The state of each master: when it was checked, whether rightly judged, when it is due; pure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum

from station.archive.reader import Row


class MasterState(StrEnum):
    """State of a master."""

    UNKNOWN = "unknown"
    """Never checked, and no check is required."""
    RIGHT = "right"
    DUE = "due"
    WRONG = "wrong"


@dataclass(frozen=True, slots=True, kw_only=True)
class MasterRow:
    """A master with its last check."""

    serial: str
    expected: str
    found: str | None = None
    """Verdict of the last check, or None if it was never checked."""
    checked: datetime | None = None
    """Time of the last check."""
    due: datetime | None = None
    """Time of the next check, or None if none is required or it was never checked."""
    state: MasterState


def master_rows(
    masters: Mapping[str, str],
    due_h: float | None,
    checks: Sequence[Row],
    now: datetime,
) -> list[MasterRow]:
    """Return all masters in the order of the settings; `checks` begin with the newest."""
    last: dict[str, Row] = {}
    for row in checks:
        last.setdefault(row.serial, row)
    every = None if due_h is None else timedelta(hours=due_h)
    return [
        _row(serial, expected, last.get(serial), every=every, now=now) for serial, expected in masters.items()
    ]


def _row(
    serial: str, expected: str, check: Row | None, *, every: timedelta | None, now: datetime
) -> MasterRow:
    if check is None:
        state = MasterState.UNKNOWN if every is None else MasterState.DUE
        return MasterRow(serial=serial, expected=expected, state=state)
    at = datetime.fromisoformat(check.grabbed_at)
    due = None if every is None else at + every
    late = due is not None and due < now
    wrong = check.verdict != expected
    state = MasterState.WRONG if wrong else MasterState.DUE if late else MasterState.RIGHT
    return MasterRow(serial=serial, expected=expected, state=state, found=check.verdict, checked=at, due=due)

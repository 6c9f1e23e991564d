"""How the masters stand: judged when, right or wrong, due when; pure."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum

from station.archive.reader import Row


class MasterState(StrEnum):
    """What has to be said of a master."""

    UNKNOWN = "unknown"
    """It was never judged, and need not be."""
    RIGHT = "right"
    DUE = "due"
    WRONG = "wrong"


@dataclass(frozen=True, slots=True)
class MasterRow:
    """One master with its last check."""

    serial: str
    expected: str
    found: str | None
    """Verdict of the last check; None: never checked."""
    checked: datetime | None
    due: datetime | None
    """Time from which on it is due; None: never, or it was never checked."""
    state: MasterState


def master_rows(
    masters: Mapping[str, str],
    due_h: float | None,
    checks: Sequence[Row],
    now: datetime,
) -> list[MasterRow]:
    """Return all masters in the order of the settings; `checks`: the newest first."""
    last: dict[str, Row] = {}
    for row in checks:
        last.setdefault(row.serial, row)
    return [_row(serial, expected, due_h, last.get(serial), now) for serial, expected in masters.items()]


def _row(serial: str, expected: str, due_h: float | None, check: Row | None, now: datetime) -> MasterRow:
    if check is None:
        state = MasterState.UNKNOWN if due_h is None else MasterState.DUE
        return MasterRow(serial, expected, None, None, None, state)
    at = datetime.fromisoformat(check.grabbed_at)
    due = None if due_h is None else at + timedelta(hours=due_h)
    late = due is not None and due < now
    wrong = check.verdict != expected
    state = MasterState.WRONG if wrong else MasterState.DUE if late else MasterState.RIGHT
    return MasterRow(serial, expected, check.verdict, at, due, state)

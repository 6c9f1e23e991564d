"""What people and the station did beside the parts: an SQLite file that only grows, each entry chained to the one before by its hash.

Read here; `journal_writer` alone writes.
"""

import hashlib
import json
import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path

from station.errors import RecordError
from station.files.sqlite import CHAIN_START, connect_to_read

NAME = "journal.sqlite"
COLUMNS = ("at", "kind", "who", "subject", "before", "after", "reason")
"""Columns of an entry that its hash covers, in this order."""


class Kind(StrEnum):
    """What an entry tells of."""

    LOGIN = "login"
    LOGIN_FAILED = "login failed"
    LOGOUT = "logout"
    USER = "user"
    SETTING = "setting"
    REVIEW = "review"
    SERVICE = "service"
    ALARM = "alarm"
    ALARM_OVER = "alarm over"
    ALARM_SEEN = "alarm acknowledged"


@dataclass(frozen=True, slots=True)
class Entry:
    """One thing done, once written never changed."""

    at: str
    """UTC, ISO 8601 with milliseconds."""
    kind: Kind
    who: str
    """Name of the user; "station" for what it does itself."""
    subject: str = ""
    """What was done to: a setting, a user, an inspection id, the code of an alarm."""
    before: str = ""
    after: str = ""
    reason: str = ""
    number: int = 0


def entries(
    folder: Path,
    kinds: Collection[Kind] = (),
    subject: str | None = None,
    newest_first: bool = True,
    limit: int | None = None,
) -> list[Entry]:
    """Entries of some kinds, or of all. None if there is no journal yet. Raises RecordError."""
    where = [f"kind IN ({', '.join('?' * len(kinds))})"] * bool(kinds) + ["subject = ?"] * (
        subject is not None
    )
    values = [*map(str, kinds), *([] if subject is None else [subject])]
    query = f"SELECT number, {', '.join(COLUMNS)} FROM entries" + (
        f" WHERE {' AND '.join(where)}" if where else ""
    )
    query += f" ORDER BY number {'DESC' if newest_first else 'ASC'}" + (
        "" if limit is None else f" LIMIT {int(limit)}"
    )
    return [
        Entry(
            *(
                row["at"],
                Kind(row["kind"]),
                row["who"],
                row["subject"],
                row["before"],
                row["after"],
                row["reason"],
            ),
            int(row["number"]),
        )
        for row in _rows(folder, query, values)
    ]


def verify_journal(folder: Path) -> Iterator[tuple[str, str]]:
    """(place, what is wrong) for all that was altered or taken out. Raises RecordError."""
    chain = CHAIN_START
    for row in _rows(folder, f"SELECT number, {', '.join(COLUMNS)}, chain FROM entries ORDER BY number", []):
        wanted = link_entry(chain, [row[name] for name in COLUMNS])
        if row["chain"] != wanted:
            yield f"{NAME}, entry {row['number']}", "was changed, or the one before it was taken out"
        chain = row["chain"]


def as_json(entry: Entry) -> str:
    """One line of JSON."""
    return json.dumps(asdict(entry))


def _rows(folder: Path, query: str, values: list[str]) -> list[dict[str, str]]:
    path = folder / NAME
    if not path.exists():
        return []
    try:
        with closing(connect_to_read(path)) as connection:
            connection.row_factory = sqlite3.Row
            if connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None:
                return []  # who made it was killed before the first entry
            return [dict(row) for row in connection.execute(query, values)]
    except sqlite3.Error as error:
        raise RecordError(f"{path}: cannot be read ({error})") from None


def link_entry(chain: str, values: list[str]) -> str:
    """Return the hash that chains an entry's values to the entry before."""
    return hashlib.sha256("\0".join([chain, *values]).encode()).hexdigest()

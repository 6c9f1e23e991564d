"""Journal of the actions of people and of the station: an SQLite file that only grows.

Each entry is chained to the previous one by its hash. This module reads; only `journal_writer` writes.
"""

import hashlib
import sqlite3
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum
from pathlib import Path

from station.errors import RecordError
from station.files.sqlite import CHAIN_START, read_rows

NAME = "journal.sqlite"
"""Name of the file in the archive."""
COLUMNS = ("at", "kind", "who", "subject", "before", "after", "reason")
"""Columns that the hash of an entry covers, in this order."""


class Kind(StrEnum):
    """Kind of an entry."""

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
    DELETED = "deleted"
    """Frames or records that were deleted for their age or for lack of space."""
    CLOCK = "clock"
    """A jump of the clock, or what a person said about it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """One entry, which is never changed once it is written."""

    at: str
    """UTC, ISO 8601 with milliseconds."""
    kind: Kind
    who: str
    """Name of the user; "station" for actions of the station itself."""
    subject: str = ""
    """Object of the action: a setting, a user, an inspection id, the code of an alarm."""
    before: str = ""
    after: str = ""
    reason: str = ""
    number: int = 0
    """Running number; 0 if the entry was not read from the journal."""


def entries(
    folder: Path,
    kinds: Collection[Kind] = (),
    subject: str | None = None,
    *,
    newest_first: bool = True,
    limit: int | None = None,
) -> list[Entry]:
    """Return the entries of some kinds, or of all; none if there is no journal yet. Raises RecordError."""
    conditions, values = [], [str(kind) for kind in kinds]
    if kinds:
        conditions.append(f"kind IN ({', '.join('?' * len(kinds))})")
    if subject is not None:
        conditions.append("subject = ?")
        values.append(subject)
    query = f"SELECT number, {', '.join(COLUMNS)} FROM entries"
    if conditions:
        query += f" WHERE {' AND '.join(conditions)}"
    query += f" ORDER BY number {'DESC' if newest_first else 'ASC'}"
    if limit is not None:
        query += f" LIMIT {int(limit)}"
    return [_entry(folder, row) for row in _rows(folder, query, values)]


def _entry(folder: Path, row: Mapping[str, str]) -> Entry:
    try:
        if datetime.fromisoformat(row["at"]).utcoffset() is None:
            raise ValueError("no offset from UTC")
        if not all(isinstance(row[name], str) for name in COLUMNS):
            raise TypeError("not a text")
        return Entry(
            at=row["at"],
            kind=Kind(row["kind"]),
            who=row["who"],
            subject=row["subject"],
            before=row["before"],
            after=row["after"],
            reason=row["reason"],
            number=int(row["number"]),
        )
    except (ValueError, TypeError):
        raise RecordError(
            f"{folder / NAME}: entry {row['number']} cannot be read: it is damaged, or of a later version"
        ) from None


def count_entries(folder: Path) -> int:
    """Return the number of entries, whatever they contain. Raises RecordError."""
    return sum(int(row["count"]) for row in _rows(folder, "SELECT COUNT(*) AS count FROM entries", []))


def verify_journal(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield (place, problem) for every entry that was modified or deleted. Raises RecordError."""
    chain = CHAIN_START
    for row in _rows(folder, f"SELECT number, {', '.join(COLUMNS)}, chain FROM entries ORDER BY number", []):
        values = [row[name] for name in COLUMNS]
        if not all(isinstance(value, str) for value in [row["chain"], *values]):
            yield f"{NAME}, entry {row['number']}", "was modified: a value is not a text"
            continue
        if row["chain"] != link_entry(chain, values):
            yield f"{NAME}, entry {row['number']}", "was modified, or the entry before it was deleted"
        chain = row["chain"]


def _rows(folder: Path, query: str, values: list[str]) -> list[dict[str, str]]:
    path = folder / NAME
    if not path.exists():
        return []
    try:
        return [dict(row) for row in read_rows(path, query, values)]
    except (sqlite3.Error, OverflowError, UnicodeError) as error:
        raise RecordError(f"{path}: cannot be read ({error})") from None


def link_entry(chain: str, values: list[str]) -> str:
    """Return the hash that chains an entry's values to the previous entry."""
    return hashlib.sha256("\0".join([chain, *values]).encode()).hexdigest()

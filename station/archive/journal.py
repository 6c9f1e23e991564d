"""What people and the station did beside the parts: an SQLite file that only grows, each entry chained to the one before by its hash."""

import hashlib
import json
import sqlite3
from collections.abc import Collection, Iterator
from contextlib import closing
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path

from station.archive.schema import START, connect_to_read
from station.errors import RecordError

NAME = "journal.sqlite"
PATIENCE_S = 2.0
"""Another process that writes is waited for."""
SCHEMA = """
CREATE TABLE IF NOT EXISTS entries (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    at TEXT NOT NULL, kind TEXT NOT NULL, who TEXT NOT NULL, subject TEXT NOT NULL,
    before TEXT NOT NULL, after TEXT NOT NULL, reason TEXT NOT NULL, chain TEXT NOT NULL
);
CREATE INDEX IF NOT EXISTS entries_kind ON entries (kind, subject, number);
CREATE TRIGGER IF NOT EXISTS entries_stay BEFORE DELETE ON entries BEGIN SELECT RAISE(ABORT, 'the journal only grows'); END;
CREATE TRIGGER IF NOT EXISTS entries_same BEFORE UPDATE ON entries BEGIN SELECT RAISE(ABORT, 'the journal only grows'); END;
"""
COLUMNS = ("at", "kind", "who", "subject", "before", "after", "reason")


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


def append(folder: Path, kind: Kind, who: str, subject: str = "", before: str = "", after: str = "", reason: str = "") -> Entry:
    """Write an entry durably. Raises RecordError; then what it tells of must not be done."""
    entry = Entry(datetime.now(UTC).isoformat(timespec="milliseconds"), kind, who, subject, before, after, reason)
    try:
        with closing(sqlite3.connect(folder / NAME, timeout=PATIENCE_S, isolation_level=None)) as connection:
            connection.execute("PRAGMA journal_mode=WAL")
            connection.execute("PRAGMA synchronous=FULL")
            connection.executescript(SCHEMA)
            connection.execute("BEGIN IMMEDIATE")
            last = connection.execute("SELECT chain FROM entries ORDER BY number DESC LIMIT 1").fetchone()
            values = [str(getattr(entry, name)) for name in COLUMNS]
            chain = _link(START if last is None else last[0], values)
            marks = ", ".join("?" * (len(COLUMNS) + 1))
            connection.execute(f"INSERT INTO entries ({', '.join(COLUMNS)}, chain) VALUES ({marks})", [*values, chain])
            connection.execute("COMMIT")
    except sqlite3.Error as error:
        raise RecordError(f"{folder / NAME}: cannot be written ({error}); nothing was changed") from None
    return entry


def entries(
    folder: Path, kinds: Collection[Kind] = (), subject: str | None = None, newest_first: bool = True, limit: int | None = None
) -> list[Entry]:
    """Entries of some kinds, or of all. None if there is no journal yet. Raises RecordError."""
    where = [f"kind IN ({', '.join('?' * len(kinds))})"] * bool(kinds) + ["subject = ?"] * (subject is not None)
    values = [*map(str, kinds), *([] if subject is None else [subject])]
    query = f"SELECT number, {', '.join(COLUMNS)} FROM entries" + (f" WHERE {' AND '.join(where)}" if where else "")
    query += f" ORDER BY number {'DESC' if newest_first else 'ASC'}" + ("" if limit is None else f" LIMIT {int(limit)}")
    return [
        Entry(*(row["at"], Kind(row["kind"]), row["who"], row["subject"], row["before"], row["after"], row["reason"]), int(row["number"]))
        for row in _rows(folder, query, values)
    ]


def verify_journal(folder: Path) -> Iterator[tuple[str, str]]:
    """(place, what is wrong) for all that was altered or taken out. Raises RecordError."""
    chain = START
    for row in _rows(folder, f"SELECT number, {', '.join(COLUMNS)}, chain FROM entries ORDER BY number", []):
        wanted = _link(chain, [row[name] for name in COLUMNS])
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
            return [dict(row) for row in connection.execute(query, values)]
    except sqlite3.Error as error:
        raise RecordError(f"{path}: cannot be read ({error})") from None


def _link(chain: str, values: list[str]) -> str:
    return hashlib.sha256("\0".join([chain, *values]).encode()).hexdigest()

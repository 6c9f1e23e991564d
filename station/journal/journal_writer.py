"""Writes the journal; used by the engine only, windows send requests to the engine."""

import sqlite3
from datetime import UTC, datetime
from pathlib import Path

from station.errors import RecordError
from station.files.sqlite import CHAIN_START, opened_for_writing
from station.journal.journal import COLUMNS, NAME, Entry, Kind, link_entry

SCHEMA = (
    """CREATE TABLE IF NOT EXISTS entries (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    at TEXT NOT NULL, kind TEXT NOT NULL, who TEXT NOT NULL, subject TEXT NOT NULL,
    before TEXT NOT NULL, after TEXT NOT NULL, reason TEXT NOT NULL, chain TEXT NOT NULL
)""",
    "CREATE INDEX IF NOT EXISTS entries_kind ON entries (kind, subject, number)",
    "CREATE TRIGGER IF NOT EXISTS entries_stay BEFORE DELETE ON entries "
    "BEGIN SELECT RAISE(ABORT, 'the journal only grows'); END",
    "CREATE TRIGGER IF NOT EXISTS entries_same BEFORE UPDATE ON entries "
    "BEGIN SELECT RAISE(ABORT, 'the journal only grows'); END",
)
"""SQL statements that create the journal."""


def append(
    folder: Path,
    kind: Kind,
    who: str,
    subject: str = "",
    *,
    before: str = "",
    after: str = "",
    reason: str = "",
) -> Entry:
    """Write an entry durably and return it. Raises RecordError; then the action must not be done."""
    entry = Entry(
        at=datetime.now(UTC).isoformat(timespec="milliseconds"),
        kind=kind,
        who=who,
        subject=subject,
        before=before,
        after=after,
        reason=reason,
    )
    try:
        with opened_for_writing(folder / NAME) as connection:
            for statement in SCHEMA:
                connection.execute(statement)
            last = connection.execute("SELECT chain FROM entries ORDER BY number DESC LIMIT 1").fetchone()
            values = [str(getattr(entry, name)) for name in COLUMNS]
            chain = link_entry(CHAIN_START if last is None else last[0], values)
            marks = ", ".join("?" * (len(COLUMNS) + 1))
            connection.execute(
                f"INSERT INTO entries ({', '.join(COLUMNS)}, chain) VALUES ({marks})", [*values, chain]
            )
    except sqlite3.Error as error:
        raise RecordError(f"{folder / NAME}: cannot be written ({error}); nothing was changed") from None
    return entry

"""The index of the archive: an SQLite file next to the day folders that any SQLite tool can read.

Each record is chained to the previous one: `chain` is the SHA-256 of the previous chain and the record's own
hash, and the record itself contains the previous chain. Deleting or modifying a record breaks the chain
there.
"""

import hashlib
import sqlite3
from pathlib import Path

from station.errors import RecordError
from station.files.sqlite import CHAIN_START, connect_to_read, connect_to_write, writing

NAME = "index.sqlite"
"""File name of the index."""
VERSION = 2
"""Version of the index that this software writes."""
SEARCHABLE_SCORE = 0.05
"""Minimum score of NOK of the segments in the table of segments; the record contains all segments."""

SCHEMA = """
CREATE TABLE IF NOT EXISTS records (
    inspection_id INTEGER PRIMARY KEY AUTOINCREMENT,
    serial TEXT NOT NULL,
    trigger_id INTEGER NOT NULL,
    grabbed_at TEXT NOT NULL,
    origin TEXT NOT NULL,
    verdict TEXT NOT NULL,
    reason TEXT,
    worst_score REAL,
    frame_file TEXT,
    record_file TEXT NOT NULL,
    record_sha256 TEXT NOT NULL,
    shown_to_plc INTEGER,
    purpose TEXT NOT NULL DEFAULT 'part',
    recipe INTEGER NOT NULL DEFAULT 1,
    chain TEXT,
    frame_state TEXT NOT NULL DEFAULT 'kept'
);
CREATE INDEX IF NOT EXISTS records_serial ON records (serial);
CREATE INDEX IF NOT EXISTS records_time ON records (grabbed_at);
CREATE INDEX IF NOT EXISTS records_verdict ON records (verdict, inspection_id);
CREATE INDEX IF NOT EXISTS records_reason ON records (reason, inspection_id);
CREATE TABLE IF NOT EXISTS segments (
    inspection_id INTEGER NOT NULL,
    segment INTEGER NOT NULL,
    p_nok REAL NOT NULL
);
CREATE INDEX IF NOT EXISTS segments_score ON segments (segment, p_nok, inspection_id);
CREATE INDEX IF NOT EXISTS segments_record ON segments (inspection_id);
CREATE TABLE IF NOT EXISTS let_go (
    inspection_id INTEGER NOT NULL,
    chain TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS to_remove (
    name TEXT NOT NULL
);
"""
ADDED = {
    "purpose": "TEXT NOT NULL DEFAULT 'part'",
    "recipe": "INTEGER NOT NULL DEFAULT 1",
    "chain": "TEXT",
    "frame_state": "TEXT NOT NULL DEFAULT 'kept'",
}
"""Columns that an index of version 1 does not have; its records have no chain."""


def open_index(folder: Path) -> sqlite3.Connection:
    """Open the index for writing; create or upgrade it if necessary.

    Raises sqlite3.Error, or RecordError if the index has a later version.
    """
    connection = connect_to_write(folder / NAME, any_thread=True)
    try:
        version = connection.execute("PRAGMA user_version").fetchone()[0]
        if version > VERSION:
            raise RecordError(
                f"{folder}: the index has version {version}, this software writes version {VERSION}; "
                "update weldgate, or set another archive.folder"
            )
        with writing(connection, folder / NAME):  # readers see the whole upgrade or nothing of it
            present = {row[1] for row in connection.execute("PRAGMA table_info(records)")}
            for name, kind in ADDED.items():
                if present and name not in present:
                    connection.execute(f"ALTER TABLE records ADD COLUMN {name} {kind}")
            for statement in SCHEMA.split(";"):
                connection.execute(statement)
            connection.execute(
                "UPDATE records SET frame_state = 'none' WHERE frame_file IS NULL AND frame_state = 'kept'"
            )
            connection.execute(f"PRAGMA user_version = {VERSION}")
    except BaseException:
        connection.close()
        raise
    return connection


def read_index(folder: Path) -> sqlite3.Connection:
    """Open the index for reading. Raises RecordError if there is no index or it has another version."""
    path = folder / NAME
    if not path.is_file():
        raise RecordError(f"{folder}: no records found ({NAME} is missing); name an archive folder")
    try:
        connection = connect_to_read(path)
        version = connection.execute("PRAGMA user_version").fetchone()[0]
    except (sqlite3.Error, UnicodeError) as error:
        raise RecordError(f"{path}: not a readable index ({error})") from None
    if version != VERSION:
        connection.close()
        raise RecordError(
            f"{path}: the index has version {version}, needed {VERSION}; the engine upgrades an older index"
        )
    connection.row_factory = sqlite3.Row
    return connection


def link(before: str, record_sha256: str) -> str:
    """Return the chain extended by one record."""
    return hashlib.sha256(f"{before}{record_sha256}".encode()).hexdigest()


def last_link(connection: sqlite3.Connection) -> str:
    """Return the chain of all records in the index."""
    for table in ("records", "let_go"):
        row = connection.execute(f"SELECT chain FROM {table} ORDER BY inspection_id DESC LIMIT 1").fetchone()
        if row is not None:
            return row[0] or CHAIN_START
    return CHAIN_START

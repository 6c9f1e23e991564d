"""Opens SQLite databases that several processes use at once: the index of the archive, and the journal."""

import os
import sqlite3
import time
from pathlib import Path

PATIENCE_S = 2.0
"""Time to wait for another process that uses the same file."""
CHAIN_START = "0" * 64
"""Start of a hash chain: the hash that precedes the first entry."""


def use_wal(connection: sqlite3.Connection) -> None:
    """Put a database into WAL mode with durable commits. Raises sqlite3.Error.

    Only the first call changes the file. For that change SQLite ignores the timeout of the connection, so
    this function waits for other processes.
    """
    until_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            break
        except sqlite3.OperationalError as error:
            if error.sqlite_errorcode & 0xFF != sqlite3.SQLITE_BUSY or time.monotonic() > until_s:
                raise
        time.sleep(0.01)
    connection.execute("PRAGMA synchronous = FULL")


def connect_to_read(path: Path) -> sqlite3.Connection:
    """Open a database in WAL mode for reading, even if its folder is read-only. Raises sqlite3.Error.

    Waits for the tables of a database that another process is just creating.
    """
    writable = os.access(path.parent, os.W_OK) or path.with_name(f"{path.name}-wal").exists()
    mode = "mode=ro" if writable else "mode=ro&immutable=1"
    connection = sqlite3.connect(f"{path.resolve().as_uri()}?{mode}", uri=True, timeout=PATIENCE_S)
    until_s = time.monotonic() + PATIENCE_S
    try:
        while (
            connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None
            and time.monotonic() < until_s
        ):
            time.sleep(0.01)
    except BaseException:
        connection.close()
        raise
    return connection

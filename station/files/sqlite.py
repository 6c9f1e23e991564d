"""SQLite files that several processes write and read at once; index of the archive and journal are such files."""

import os
import sqlite3
import time
from pathlib import Path

PATIENCE_S = 2.0
"""Time for which another process that uses the same file is waited for."""
CHAIN_START = "0" * 64
"""Hash before the first entry, where each entry is chained to the one before."""


def use_wal(connection: sqlite3.Connection) -> None:
    """Put a database into WAL mode, each commit durable. Raises sqlite3.Error.

    Only the first time changes the file. SQLite does not wait for others then, whatever the connection's timeout, so it is done here.
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
    """Open a database in WAL mode, also where nobody may write the log next to it. Raises sqlite3.Error.

    One that another process makes at this moment has no tables yet: they are waited for.
    """
    writable = os.access(path.parent, os.W_OK) or path.with_name(f"{path.name}-wal").exists()
    how = "mode=ro" if writable else "mode=ro&immutable=1"
    connection = sqlite3.connect(f"{path.resolve().as_uri()}?{how}", uri=True, timeout=PATIENCE_S)
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

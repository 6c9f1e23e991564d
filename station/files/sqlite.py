"""Opens SQLite databases that several processes use at once: the index of the archive, and the journal.

Writers of one file take turns by a lock file next to it; for what is left, such as readers and programs of
others, there is one wait, `patiently`. SQLite's own is not enough: it is not called where a file changes its
mode or is recovered, and it asks so rarely that one of many writers may never find the file free.
"""

import os
import random
import sqlite3
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager, suppress
from pathlib import Path
from typing import TypeVar

from station.files.lock import turn
from station.files.private import close_to

MODE, OTHERS = 0o640, 0o007
"""Mode of a new database, and the bits that none has."""
PATIENCE_S = 5.0
"""Time to wait for other processes that use the same file."""
PAUSE_S = (0.001, 0.008)
"""Shortest and longest pause between two attempts, drawn at random so that every process gets its turn."""
BUSY = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_PROTOCOL)
"""Error codes that say that another process uses the file just now."""
CHANGING = (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY_RECOVERY, sqlite3.SQLITE_READONLY_CANTINIT)
"""Error codes of a reader while another process makes or removes the files of the WAL."""
CHAIN_START = "0" * 64
"""Start of a hash chain: the hash that precedes the first entry."""

Result = TypeVar("Result")


def patiently(work: Callable[[], Result], *, codes: tuple[int, ...] = BUSY) -> Result:
    """Do `work` again and again until no other process is in its way, and return its result.

    `work` must do nothing, or nothing twice, where it fails. Raises sqlite3.Error after PATIENCE_S.
    """
    until_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            return work()
        except sqlite3.OperationalError as error:
            code = getattr(error, "sqlite_errorcode", -1)  # an error of the Python module has none
            known = code in codes or (code > 0 and code & 0xFF in codes)
            if not known or time.monotonic() > until_s:
                raise
        except UnicodeError:  # the text of an error contains bytes of a damaged file
            raise sqlite3.DatabaseError("the file is damaged") from None
        time.sleep(random.uniform(*PAUSE_S))


def connect_to_write(path: Path, *, any_thread: bool = False) -> sqlite3.Connection:
    """Open a database for writing, in WAL mode with durable commits; create it if it is missing.

    Transactions are those of `writing` alone. `any_thread`: threads may share the connection, one at a time.
    Raises sqlite3.Error.
    """

    _close_to_others(path)

    def connect() -> sqlite3.Connection:
        connection = sqlite3.connect(
            path, timeout=0.0, isolation_level=None, check_same_thread=not any_thread
        )
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            connection.execute("PRAGMA synchronous = FULL")
        except BaseException:
            connection.close()
            raise
        return connection

    return patiently(connect)


def _close_to_others(path: Path) -> None:
    """Make the files of a database readable by owner and group only; create it empty if it is missing.

    Who may read them may hold the locks of SQLite, and so stall the writer.
    """
    with suppress(OSError):  # what is wrong with the file is said by SQLite
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, MODE))
    for suffix in ("", "-wal", "-shm"):
        close_to(path.with_name(path.name + suffix), OTHERS)


@contextmanager
def writing(connection: sqlite3.Connection, path: Path) -> Iterator[None]:
    """Make one transaction on the database `path`, which is committed at the end and undone after an error.

    It waits for its turn among all writers of the file. Raises sqlite3.Error.
    """
    with _turn(path), _transaction(connection):
        yield


@contextmanager
def opened_for_writing(path: Path) -> Iterator[sqlite3.Connection]:
    """Open a database for one transaction like `writing`, and close it. Raises sqlite3.Error."""
    with _turn(path), closing(connect_to_write(path)) as connection, _transaction(connection):
        yield connection


@contextmanager
def _transaction(connection: sqlite3.Connection) -> Iterator[None]:
    patiently(lambda: connection.execute("BEGIN IMMEDIATE"))
    try:
        yield
        patiently(lambda: connection.execute("COMMIT"))
    except BaseException:
        if connection.in_transaction:
            connection.execute("ROLLBACK")
        raise


@contextmanager
def _turn(path: Path) -> Iterator[None]:
    with ExitStack() as stack:
        try:
            stack.enter_context(turn(path.with_name(f"{path.name}.lock"), PATIENCE_S))
        except OSError as error:
            raise sqlite3.OperationalError(error.strerror) from None
        yield


def connect_to_read(path: Path) -> sqlite3.Connection:
    """Open a database in WAL mode for reading, even if its folder is read-only. Raises sqlite3.Error.

    Waits for the tables of a database that another process is just creating.
    """
    until_s = time.monotonic() + PATIENCE_S
    while True:
        connection, has_tables = patiently(lambda: _opened(path), codes=BUSY + CHANGING)
        if has_tables or time.monotonic() > until_s:
            return connection
        connection.close()
        time.sleep(random.uniform(*PAUSE_S))


def _opened(path: Path) -> tuple[sqlite3.Connection, bool]:
    """Return a connection for reading, and whether the database has tables."""
    writable = os.access(path.parent, os.W_OK) or path.with_name(f"{path.name}-wal").exists()
    mode = "mode=ro" if writable else "mode=ro&immutable=1"
    connection = sqlite3.connect(f"{path.resolve().as_uri()}?{mode}", uri=True, timeout=PATIENCE_S)
    connection.text_factory = lambda raw: raw.decode("utf-8", "replace")  # damaged text fails its hash
    try:
        return connection, connection.execute("SELECT 1 FROM sqlite_master").fetchone() is not None
    except BaseException:
        connection.close()
        raise


def read_rows(path: Path, query: str, values: list[str]) -> list[sqlite3.Row]:
    """Return the rows that a query finds in a database, none if it has no tables. Raises sqlite3.Error."""

    def read() -> list[sqlite3.Row]:
        with closing(connect_to_read(path)) as connection:
            connection.row_factory = sqlite3.Row
            if connection.execute("SELECT 1 FROM sqlite_master").fetchone() is None:
                return []
            return connection.execute(query, values).fetchall()

    return patiently(read, codes=BUSY + CHANGING)

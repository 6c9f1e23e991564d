"""Searches, reads and verifies the records of an archive."""

import hashlib
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, fields
from datetime import datetime
from pathlib import Path

from station.archive.rows import RECORD_FILE, as_row
from station.archive.rows import Row as Row
from station.archive.schema import link, read_index
from station.errors import RecordError
from station.files.regular import read_regular
from station.files.sqlite import CHAIN_START
from station.records import Record, from_json

MAX_RECORD_BYTES, MAX_FRAME_BYTES = 16_000_000, 1_000_000_000
"""Maximum size of a record and of a frame that is read."""
WRITTEN_S = 1.0
"""Maximum time from the writing of a record's files to its row in the index."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Query:
    """Conditions of a search for records; None means any value."""

    number: int | None = None
    serial: str | None = None
    """Exact serial, or a prefix followed by *."""
    since: datetime | None = None
    until: datetime | None = None
    verdict: str | None = None
    reason: str | None = None
    segment: int | None = None
    """Number of a segment, 1 to 21, whose score is at least `min_score`."""
    min_score: float | None = None
    """Minimum score of NOK, 0.05 or higher, of the segment or else of the worst segment."""
    purpose: str | None = None
    recipe: int | None = None
    newest_first: bool = False
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Listed:
    """One entry of the index, with its record if it can be read, and its problem if it has one."""

    row: Row
    path: Path
    record: Record | None
    problem: str | None

    @property
    def shown_to_plc(self) -> bool | None:
        """True if the PLC could read the verdict; None if the station stopped before it could note this."""
        return self.row.shown_to_plc


def find(folder: Path, query: Query = Query()) -> list[Row]:
    """Return the matching rows by number. Raises RecordError if the folder is not an archive."""
    joined = query.segment is not None
    conditions, values = _conditions(query)
    where = f" WHERE {' AND '.join(conditions)}" if conditions else ""
    order = " ORDER BY r.inspection_id" + (" DESC" if query.newest_first else "")
    limit = "" if query.limit is None else f" LIMIT {int(query.limit)}"
    names = ", ".join(f"r.{field.name}" for field in fields(Row))
    join = " JOIN segments s ON s.inspection_id = r.inspection_id" if joined else ""
    with closing(read_index(folder)) as connection:
        try:
            rows = connection.execute(
                f"SELECT {names} FROM records r{join}{where}{order}{limit}", values
            ).fetchall()
        except (sqlite3.Error, OverflowError, UnicodeError) as error:
            raise RecordError(f"{folder}: the index cannot be read ({error})") from None
    try:
        return [as_row(dict(row)) for row in rows]
    except RecordError as error:
        raise RecordError(f"{folder}: {error}") from None


def _conditions(query: Query) -> tuple[list[str], list[str | float]]:
    chosen: list[tuple[str, str | float | None]] = [
        ("r.inspection_id = ?", query.number),
        ("r.grabbed_at >= ?", None if query.since is None else query.since.isoformat()),
        ("r.grabbed_at < ?", None if query.until is None else query.until.isoformat()),
        ("r.verdict = ?", query.verdict),
        ("r.reason = ?", query.reason),
        ("r.purpose = ?", query.purpose),
        ("r.recipe = ?", query.recipe),
        ("s.segment = ?", query.segment),
        ("s.p_nok >= ?" if query.segment is not None else "r.worst_score >= ?", query.min_score),
    ]
    if query.serial is not None and query.serial.endswith("*"):
        chosen += [("r.serial >= ?", query.serial[:-1]), ("r.serial < ?", query.serial[:-1] + "\U0010ffff")]
    else:
        chosen.append(("r.serial = ?", query.serial))
    return [condition for condition, value in chosen if value is not None], [
        value for _, value in chosen if value is not None
    ]


def read_records(folder: Path, query: Query = Query()) -> Iterator[Listed]:
    """Yield the matching records in order of their number, each with its problem if it has one.

    Raises RecordError if the folder is not an archive.
    """
    for row in find(folder, query):
        record, problem = read_record(folder, row)
        yield Listed(row, folder / row.record_file, record, problem)


def read_record(folder: Path, row: Row) -> tuple[Record | None, str | None]:
    """Return a record, or None if it cannot be read, and the problem of the record or its frame, or None."""
    record, problem = read_words(folder, row)
    return record, problem if record is None else _frame_problem(folder, row, record)


def read_words(folder: Path, row: Row) -> tuple[Record | None, str | None]:
    """Return a record and None, or None and why it cannot be read; its frame is not checked."""
    try:
        text = read_regular(folder / row.record_file, MAX_RECORD_BYTES)
    except OSError as error:
        return None, f"cannot be read ({error.strerror})"
    if hashlib.sha256(text).hexdigest() != row.record_sha256:
        return None, "was modified after it was written"
    try:
        return from_json(text), None
    except ValueError:
        return None, "is not a record of a known version"


def _frame_problem(folder: Path, row: Row, record: Record) -> str | None:
    if row.frame_file is None or row.frame_state != "kept":
        return None
    try:
        png = read_regular(folder / row.frame_file, MAX_FRAME_BYTES)
    except OSError as error:
        return f"its frame {row.frame_file} cannot be read ({error.strerror})"
    return (
        None
        if hashlib.sha256(png).hexdigest() == record.frame_sha256
        else f"its frame {row.frame_file} was modified"
    )


def verify(folder: Path) -> Iterator[tuple[str, str]]:
    """Yield (file or place, problem) for everything that is missing, modified or deleted.

    The engine may continue to write records meanwhile. Raises RecordError if the folder is not an archive.
    """
    (chain, before), rows = _last_pruned(folder), find(folder)
    if rows and before > rows[0].inspection_id:
        raise RecordError(f"{folder}: the archive is being pruned; verify it again")
    for row in rows:
        if row.inspection_id != before + 1 and _last_pruned(folder)[1] < row.inspection_id - 1:
            yield f"records {before + 1} to {row.inspection_id - 1}", "were deleted from the index"
        for problem in _problems(folder, row, chain):
            if find(folder, Query(number=row.inspection_id)) == [row]:  # not pruned meanwhile
                yield row.record_file, problem
        chain, before = row.chain or CHAIN_START, row.inspection_id
    listed = {name for row in rows for name in (row.record_file, row.frame_file) if name is not None}
    for path in sorted(folder.glob("????-??-??/*")):
        name = path.relative_to(folder).as_posix()
        if (
            name not in listed
            and not path.name.endswith(".part")
            and not _being_written(folder, path, before)
        ):
            yield name, "is not in the index: left over from an interrupted part, or added later"


def _being_written(folder: Path, path: Path, last: int) -> bool:
    """Return whether the engine is just writing this file: then it is in the index a moment later."""
    if not RECORD_FILE.fullmatch(f"{path.parent.name}/{path.stem}.json") or int(path.stem) <= last:
        return False
    until = time.monotonic() + WRITTEN_S
    while not find(folder, Query(number=int(path.stem))):
        if time.monotonic() > until:
            return False
        time.sleep(0.02)
    return True


def _problems(folder: Path, row: Row, chain: str) -> Iterator[str]:
    record, problem = read_record(folder, row)
    if problem is not None:
        yield problem
    if record is not None:
        inspection = record.inspection
        recorded = (
            record.serial,
            record.trigger_id,
            record.grabbed_at.isoformat(),
            str(record.verdict),
            record.frame_file,
        )
        listed = (row.serial, row.trigger_id, row.grabbed_at, row.verdict, row.frame_file)
        reason = None if inspection.reason is None else str(inspection.reason)
        if recorded != listed or (reason, str(record.purpose)) != (row.reason, row.purpose):
            yield "does not match its entry in the index; the index was modified"
    if row.chain is not None:
        if row.chain != link(chain, row.record_sha256):
            yield "does not follow the previous record; a record was deleted or replaced here"
        elif record is not None and record.chain_before != chain:
            yield "names a different previous record"


def _last_pruned(folder: Path) -> tuple[str, int]:
    """Return chain and number of the last record that was pruned."""
    with closing(read_index(folder)) as connection:
        try:
            row = connection.execute(
                "SELECT chain, inspection_id FROM let_go ORDER BY inspection_id DESC LIMIT 1"
            ).fetchone()
        except (sqlite3.Error, UnicodeError) as error:
            raise RecordError(f"{folder}: the index cannot be read ({error})") from None
    if row is None:
        return CHAIN_START, 0
    if not (isinstance(row["chain"], str) and isinstance(row["inspection_id"], int)):
        raise RecordError(f"{folder}: the index is damaged: table let_go")
    return row["chain"], row["inspection_id"]

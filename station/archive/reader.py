"""Finds and reads records."""

import hashlib
import sqlite3
import time
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from pydantic import ValidationError

from station.archive.schema import link, read_index
from station.errors import RecordError
from station.files.sqlite import CHAIN_START
from station.records import Record, from_json

WRITTEN_S = 1.0
"""A record is listed at the latest so long after its files are there."""


@dataclass(frozen=True, slots=True)
class Wanted:
    """What is looked for; None: anything."""

    number: int | None = None
    serial: str | None = None
    """Exactly, or its beginning with * behind it."""
    since: datetime | None = None
    until: datetime | None = None
    verdict: str | None = None
    reason: str | None = None
    segment: int | None = None
    """1 to 21, together with `min_score`."""
    min_score: float | None = None
    """Score of NOK, at least 0.05: of the segment, or of the worst."""
    purpose: str | None = None
    recipe: int | None = None
    newest_first: bool = False
    limit: int | None = None


@dataclass(frozen=True, slots=True)
class Row:
    """One row of the index."""

    inspection_id: int
    serial: str
    trigger_id: int
    grabbed_at: str
    verdict: str
    reason: str | None
    worst_score: float | None
    frame_file: str | None
    frame_state: str
    """kept, thinned (left out for lack of room), pruned (let go), none (no picture came)."""
    record_file: str
    record_sha256: str
    shown_to_plc: bool | None
    """None: the station stopped before it could tell."""
    purpose: str
    recipe: int
    chain: str | None


@dataclass(frozen=True, slots=True)
class Listed:
    """One entry of the index: the record if it can be read, and what is wrong with it, if anything."""

    row: Row
    path: Path
    record: Record | None
    problem: str | None

    @property
    def shown_to_plc(self) -> bool | None:
        """None: the station stopped before it could tell."""
        return self.row.shown_to_plc


def find(folder: Path, wanted: Wanted = Wanted()) -> list[Row]:
    """Rows in order of their number. Raises RecordError if the folder holds no archive."""
    joined = wanted.segment is not None
    conditions, values = _conditions(wanted)
    where = f" WHERE {' AND '.join(conditions)}" if conditions else ""
    order = " ORDER BY r.inspection_id" + (" DESC" if wanted.newest_first else "")
    limit = "" if wanted.limit is None else f" LIMIT {int(wanted.limit)}"
    names = ", ".join(f"r.{name}" for name in Row.__slots__)
    join = " JOIN segments s ON s.inspection_id = r.inspection_id" if joined else ""
    with closing(read_index(folder)) as connection:
        try:
            rows = connection.execute(
                f"SELECT {names} FROM records r{join}{where}{order}{limit}", values
            ).fetchall()
        except sqlite3.Error as error:
            raise RecordError(f"{folder}: the index cannot be read ({error})") from None
    return [
        Row(
            **{
                **dict(row),
                "shown_to_plc": None if row["shown_to_plc"] is None else bool(row["shown_to_plc"]),
            }
        )
        for row in rows
    ]


def _conditions(wanted: Wanted) -> tuple[list[str], list[str | float]]:
    chosen: list[tuple[str, str | float | None]] = [
        ("r.inspection_id = ?", wanted.number),
        ("r.grabbed_at >= ?", None if wanted.since is None else wanted.since.isoformat()),
        ("r.grabbed_at < ?", None if wanted.until is None else wanted.until.isoformat()),
        ("r.verdict = ?", wanted.verdict),
        ("r.reason = ?", wanted.reason),
        ("r.purpose = ?", wanted.purpose),
        ("r.recipe = ?", wanted.recipe),
        ("s.segment = ?", wanted.segment),
        ("s.p_nok >= ?" if wanted.segment is not None else "r.worst_score >= ?", wanted.min_score),
    ]
    if wanted.serial is not None and wanted.serial.endswith("*"):
        chosen += [("r.serial >= ?", wanted.serial[:-1]), ("r.serial < ?", wanted.serial[:-1] + "\U0010ffff")]
    else:
        chosen.append(("r.serial = ?", wanted.serial))
    return [condition for condition, value in chosen if value is not None], [
        value for _, value in chosen if value is not None
    ]


def read_records(folder: Path, wanted: Wanted = Wanted()) -> Iterator[Listed]:
    """Records in order of their number, each with what is wrong with its files. Raises RecordError if the folder holds no archive."""
    for row in find(folder, wanted):
        record, problem = read_record(folder, row)
        yield Listed(row, folder / row.record_file, record, problem)


def read_record(folder: Path, row: Row) -> tuple[Record | None, str | None]:
    """A record and what is wrong with it or its frame, if anything."""
    record, problem = read_words(folder, row)
    return record, problem if record is None else _frame_problem(folder, row, record)


def read_words(folder: Path, row: Row) -> tuple[Record | None, str | None]:
    """A record, or why it cannot be read; its frame is not looked at."""
    try:
        text = (folder / row.record_file).read_bytes()
    except OSError as error:
        return None, f"cannot be read ({error.strerror})"
    if hashlib.sha256(text).hexdigest() != row.record_sha256:
        return None, "was changed after it was written"
    try:
        return from_json(text), None
    except ValidationError:
        return None, "is not a record of this version"


def _frame_problem(folder: Path, row: Row, record: Record) -> str | None:
    if row.frame_file is None or row.frame_state != "kept":
        return None
    try:
        png = (folder / row.frame_file).read_bytes()
    except OSError as error:
        return f"its frame {row.frame_file} cannot be read ({error.strerror})"
    return (
        None
        if hashlib.sha256(png).hexdigest() == record.frame_sha256
        else f"its frame {row.frame_file} was changed"
    )


def verify(folder: Path) -> Iterator[tuple[str, str]]:
    """(file or place, what is wrong) for all that is missing, altered or taken out; an engine may go on meanwhile.

    Raises RecordError if there is no archive.
    """
    (chain, before), rows = _let_go(folder), find(folder)
    if rows and before > rows[0].inspection_id:
        raise RecordError(f"{folder}: is being pruned; verify again")
    for row in rows:
        if row.inspection_id != before + 1 and _let_go(folder)[1] < row.inspection_id - 1:
            yield f"records {before + 1} to {row.inspection_id - 1}", "were taken out of the index"
        for problem in _problems(folder, row, chain):
            if find(folder, Wanted(number=row.inspection_id)) == [row]:  # not let go meanwhile
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
            yield name, "is not listed: left by a stop in the middle of a part, or put here"


def _being_written(folder: Path, path: Path, last: int) -> bool:
    """Whether an engine goes on meanwhile: a file after the last row is listed a moment later."""
    if not path.stem.isdecimal() or int(path.stem) <= last:
        return False
    until = time.monotonic() + WRITTEN_S
    while not find(folder, Wanted(number=int(path.stem))):
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
        said = (
            record.serial,
            record.trigger_id,
            record.grabbed_at.isoformat(),
            str(record.verdict),
            record.frame_file,
        )
        listed = (row.serial, row.trigger_id, row.grabbed_at, row.verdict, row.frame_file)
        reason = None if inspection.reason is None else str(inspection.reason)
        if said != listed or (reason, str(record.purpose)) != (row.reason, row.purpose):
            yield "is listed with other words than it says itself: the index was altered"
    if row.chain is not None:
        if row.chain != link(chain, row.record_sha256):
            yield "does not follow the record before it: something here was taken out or exchanged"
        elif record is not None and record.chain_before != chain:
            yield "names another record before it"


def _let_go(folder: Path) -> tuple[str, int]:
    with closing(read_index(folder)) as connection:
        try:
            row = connection.execute(
                "SELECT chain, inspection_id FROM let_go ORDER BY inspection_id DESC LIMIT 1"
            ).fetchone()
        except sqlite3.Error as error:
            raise RecordError(f"{folder}: the index cannot be read ({error})") from None
    return (CHAIN_START, 0) if row is None else (row["chain"], row["inspection_id"])

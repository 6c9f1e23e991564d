"""Writes records so that none is lost: files, fsync, index row, and only then may the verdict be seen."""

import hashlib
import os
import shutil
import sqlite3
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import closing
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from pydantic import ValidationError

from station.domain import Frame, Inspection
from station.errors import ImageError, RecordError
from station.filelock import FolderLock
from station.imagefile import encode_png
from station.records import Part, Provenance, Record, from_json, to_json
from station.settings import ArchiveSettings

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
    shown_to_plc INTEGER
);
CREATE INDEX IF NOT EXISTS records_serial ON records (serial);
CREATE INDEX IF NOT EXISTS records_time ON records (grabbed_at);
"""


@dataclass(frozen=True, slots=True)
class Pending:
    """A frame being encoded while it is judged."""

    frame: Frame | None
    png: "Future[bytes] | None"


class Archive:
    """Keeper of one folder of records; one engine at a time."""

    def __init__(self, settings: ArchiveSettings) -> None:
        """Open or create the archive. Raises RecordError if the folder cannot be used."""
        self._folder = settings.folder
        self._min_free_bytes = settings.min_free_mb * 1_000_000
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._lock = FolderLock(self._folder)
            self._index = sqlite3.connect(self._folder / "index.sqlite", timeout=2.0, check_same_thread=False)
            self._index.execute("PRAGMA journal_mode = WAL")
            self._index.execute("PRAGMA synchronous = FULL")
            self._index.executescript(SCHEMA)
        except BlockingIOError:
            raise RecordError(f"{self._folder}: another engine keeps its records there; stop it or set archive.folder") from None
        except (OSError, sqlite3.Error) as error:
            raise RecordError(f"{self._folder}: records cannot be kept there ({error}); set archive.folder to a writable folder") from None
        self._encoder = ThreadPoolExecutor(1, "encode")

    def close(self) -> None:
        """Finish and close the index."""
        self._encoder.shutdown(wait=True)
        self._index.close()
        self._lock.close()

    def has_room(self) -> bool:
        """Whether the disk has the room that the settings ask for."""
        try:
            return shutil.disk_usage(self._folder).free >= self._min_free_bytes
        except OSError:
            return False

    def begin(self, frame: Frame | None) -> Pending:
        """Start to encode the frame while it is being judged."""
        return Pending(frame, None if frame is None else self._encoder.submit(encode_png, frame.image))

    def commit(
        self,
        pending: Pending,
        inspection: Inspection,
        part: Part,
        provenance: Provenance,
        now: datetime,
    ) -> Record:
        """Make the record durable and return it. Raises RecordError; then nothing is listed."""
        try:
            return self._commit(pending, inspection, part, provenance, now)
        except (OSError, sqlite3.Error, ImageError, ValueError) as error:
            if self._index.in_transaction:
                self._index.rollback()
            raise RecordError(f"{self._folder}: the record could not be written: {error}") from None

    def mark_shown(self, inspection_id: int, shown: bool) -> None:
        """Note whether the PLC was shown this verdict; NULL: the station stopped before it could tell."""
        try:
            with self._index:
                self._index.execute("UPDATE records SET shown_to_plc = ? WHERE inspection_id = ?", (shown, inspection_id))
        except sqlite3.Error as error:
            raise RecordError(f"{self._folder}: record {inspection_id} could not be marked: {error}") from None

    def _commit(
        self,
        pending: Pending,
        inspection: Inspection,
        part: Part,
        provenance: Provenance,
        now: datetime,
    ) -> Record:
        row = self._index.execute("SELECT seq FROM sqlite_sequence WHERE name = 'records'").fetchone()
        inspection_id = 1 + (row[0] if row else 0)
        day = self._folder / f"{now:%Y-%m-%d}"
        if not day.exists():
            day.mkdir()
            _sync_folder(self._folder)
        frame_file = sha256 = None
        if pending.frame is not None and pending.png is not None:
            png = pending.png.result()
            frame_file, sha256 = f"{day.name}/{inspection_id:08d}.png", hashlib.sha256(png).hexdigest()
            _write(self._folder / frame_file, png)
        record = Record(
            inspection_id=inspection_id,
            serial=part.serial,
            trigger_id=part.trigger_id,
            grabbed_at=now if pending.frame is None else pending.frame.grabbed_at,
            source="" if pending.frame is None else pending.frame.source,
            origin=part.origin,
            frame_file=frame_file,
            frame_sha256=sha256,
            inspection=inspection,
            provenance=provenance,
            purpose=part.purpose,
        )
        text = to_json(record)
        record_file = f"{day.name}/{inspection_id:08d}.json"
        _write(self._folder / record_file, text)
        _sync_folder(day)
        worst = max((s.nok for s in inspection.scores), default=None)
        with self._index:
            self._index.execute(
                "INSERT INTO records VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, NULL)",
                (
                    inspection_id,
                    part.serial,
                    part.trigger_id,
                    record.grabbed_at.isoformat(),
                    part.origin,
                    inspection.verdict,
                    inspection.reason,
                    worst,
                    frame_file,
                    record_file,
                    hashlib.sha256(text).hexdigest(),
                ),
            )
        return record


@dataclass(frozen=True, slots=True)
class Listed:
    """One entry of the index: its file, the record if it can be read, and what is wrong with it, if anything."""

    path: Path
    record: Record | None
    problem: str | None
    shown_to_plc: bool | None
    """None: the station stopped before it could tell."""


def read_records(folder: Path) -> Iterator[Listed]:
    """All listed records in order.

    Raises RecordError if the folder holds no archive.
    """
    index = folder / "index.sqlite"
    if not index.is_file():
        raise RecordError(f"{folder}: no records here (index.sqlite is missing); name an archive folder")
    query = "SELECT record_file, record_sha256, shown_to_plc FROM records ORDER BY inspection_id"
    try:
        with closing(sqlite3.connect(index.resolve().as_uri() + "?mode=ro", uri=True)) as connection:
            rows = connection.execute(query).fetchall()
    except sqlite3.Error as error:
        raise RecordError(f"{index}: not a readable index ({error})") from None
    for name, digest, shown in rows:
        record, problem = _read(folder, folder / name, digest)
        yield Listed(folder / name, record, problem, None if shown is None else bool(shown))


def _read(folder: Path, path: Path, digest: str) -> tuple[Record | None, str | None]:
    try:
        text = path.read_bytes()
    except OSError as error:
        return None, f"cannot be read ({error.strerror})"
    if hashlib.sha256(text).hexdigest() != digest:
        return None, "was changed after it was written"
    try:
        record = from_json(text)
    except ValidationError:
        return None, "is not a record of this version"
    return record, _frame_problem(folder, record)


def _frame_problem(folder: Path, record: Record) -> str | None:
    if record.frame_file is None:
        return None
    try:
        png = (folder / record.frame_file).read_bytes()
    except OSError as error:
        return f"its frame {record.frame_file} cannot be read ({error.strerror})"
    return None if hashlib.sha256(png).hexdigest() == record.frame_sha256 else f"its frame {record.frame_file} was changed"


def _write(path: Path, data: bytes) -> None:
    """Write under a temporary name, fsync, rename: never half a file under its name."""
    part = path.with_name(path.name + ".part")
    with part.open("wb") as file:
        file.write(data)
        file.flush()
        os.fsync(file.fileno())
    part.replace(path)


def _sync_folder(folder: Path) -> None:
    if os.name != "posix":
        return
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)

"""Deletes frames and records after their retention, in small steps so that the engine never waits for it."""

import hashlib
import logging
import sqlite3
import threading
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from station.archive.schema import NAME
from station.errors import RecordError
from station.files.durable import sync_folder
from station.files.sqlite import CHAIN_START, connect_to_write, patiently, writing
from station.settings.model import KeepSettings

log = logging.getLogger("weldgate.archive")

STEP = 50
"""Number of records in one transaction."""
EVERY_S = 3600.0
"""Interval of the engine's pruning."""
GIB = 1 << 30
"""Bytes in a GiB."""
STRANGE = timedelta(days=7)
"""Age of the newest record above which the clock is assumed to be wrong."""


@dataclass(frozen=True, slots=True)
class Pruned:
    """Number and size of the frames and records that were deleted, or would be."""

    frames: int = 0
    records: int = 0
    bytes: int = 0

    def __add__(self, other: "Pruned") -> "Pruned":
        return Pruned(self.frames + other.frames, self.records + other.records, self.bytes + other.bytes)


def prune(
    folder: Path, keep: KeepSettings, now: datetime, *, dry: bool = False, stop: threading.Event | None = None
) -> Pruned:
    """Delete frames and records past their retention, and the oldest frames above the quota.

    With `dry`, nothing is deleted. Nothing is deleted either if the newest record is more than a week old:
    then the clock is probably wrong. Raises RecordError.
    """
    if not (folder / NAME).is_file():
        raise RecordError(f"{folder}: no records found ({NAME} is missing); name an archive folder")
    try:
        with closing(connect_to_write(folder / NAME)) as index:
            newest = index.execute("SELECT MAX(grabbed_at) FROM records").fetchone()[0]
            if newest is None or now - datetime.fromisoformat(newest) > STRANGE:
                return Pruned()
            work = _Work(folder, index, dry, stop or threading.Event())
            work.remove_leftovers()
            done = Pruned()
            for condition, days in _old_frames(keep):
                done += work.delete_frames(condition, _first_young(index, now - timedelta(days=days)), None)
            excess = work.stored_bytes() - keep.quota_gib * GIB
            for condition in ("verdict = 'OK'", "verdict = 'ERROR'", "1"):
                if excess > 0:
                    more = work.delete_frames(condition, 1 << 62, excess)
                    done, excess = done + more, excess - more.bytes
            return done + work.delete_records(_first_young(index, now - timedelta(days=keep.record_days)))
    except (sqlite3.Error, OSError) as error:
        raise RecordError(f"{folder}: could not be pruned ({error})") from None


def sampled(inspection_id: int, fraction: float) -> bool:
    """Return whether the frame of an OK part is kept longer; depends on nothing but the two arguments."""
    return int.from_bytes(hashlib.sha256(str(inspection_id).encode()).digest()[:4], "big") < fraction * 2**32


def _old_frames(keep: KeepSettings) -> list[tuple[str, int]]:
    """Return conditions on the frames, each with its retention in days."""
    return [
        (f"verdict = 'OK' AND NOT sampled(inspection_id, {float(keep.ok_share)})", keep.ok_all_days),
        ("verdict = 'OK'", keep.ok_days),
        ("verdict = 'NOK'", keep.nok_days),
        ("verdict = 'ERROR'", keep.error_days),
    ]


def _first_young(index: sqlite3.Connection, when: datetime) -> int:
    """Return the number of the first record that is not older than `when`.

    All records before it count as older, even if a wrong clock gave some of them a later time.
    """
    row = index.execute(
        "SELECT MIN(inspection_id) FROM records WHERE grabbed_at >= ?", (when.isoformat(),)
    ).fetchone()
    return 1 << 62 if row[0] is None else int(row[0])


class _Work:
    """One run over an index. The names of files are noted before they are deleted, so that an interrupted run
    leaves no files behind."""

    def __init__(self, folder: Path, index: sqlite3.Connection, dry: bool, stop: threading.Event) -> None:
        self._folder, self._index, self._dry, self._stop = folder, index, dry, stop
        self._deleted: set[int] = set()
        """Numbers of the records whose frames were deleted in this run."""
        index.create_function("sampled", 2, sampled, deterministic=True)

    def remove_leftovers(self) -> None:
        """Delete the files that an interrupted run noted but did not delete."""
        if not self._dry:
            for (name,) in self._index.execute("SELECT name FROM to_remove").fetchall():
                self._remove(name)

    def stored_bytes(self) -> int:
        """Return the size of all frames that remain."""
        rows = self._index.execute(
            "SELECT inspection_id, frame_file FROM records "
            "WHERE frame_state = 'kept' AND frame_file IS NOT NULL"
        )
        return sum(_size(self._folder / name) for number, name in rows if number not in self._deleted)

    def delete_frames(self, condition: str, before: int, enough_bytes: float | None) -> Pruned:
        """Delete frames of records before a number, the oldest first, until `enough_bytes` are freed."""
        done, after = Pruned(), 0
        query = (
            "SELECT inspection_id, frame_file FROM records "
            "WHERE frame_state = 'kept' AND frame_file IS NOT NULL "
            f"AND inspection_id > ? AND inspection_id < ? AND {condition} ORDER BY 1 LIMIT {STEP}"
        )
        while not self._stop.is_set() and (enough_bytes is None or done.bytes < enough_bytes):
            self._begin()
            rows = self._index.execute(query, (after, before)).fetchall()
            chosen = []
            for number, name in rows:
                after = number
                if number in self._deleted or (enough_bytes is not None and done.bytes >= enough_bytes):
                    continue
                chosen.append((number, name))
                done += Pruned(1, 0, _size(self._folder / name))
            self._deleted |= {number for number, _ in chosen}
            if not self._dry:
                marks = [(number,) for number, _ in chosen]
                self._index.executemany(
                    "UPDATE records SET frame_state = 'pruned' WHERE inspection_id = ?", marks
                )
            self._commit([name for _, name in chosen])
            if not rows:
                break
        return done

    def delete_records(self, before: int) -> Pruned:
        """Delete the records before a number; the remaining chain starts where theirs ended."""
        done, after = Pruned(), 0
        while not self._stop.is_set():
            self._begin()
            rows = self._index.execute(
                "SELECT inspection_id, record_file, frame_file, chain FROM records "
                f"WHERE inspection_id > ? AND inspection_id < ? ORDER BY 1 LIMIT {STEP}",
                (after, before),
            ).fetchall()
            names = [row[1] for row in rows] + [
                row[2] for row in rows if row[2] is not None and row[0] not in self._deleted
            ]
            done += Pruned(0, len(rows), sum(_size(self._folder / name) for name in names))
            if rows and not self._dry:
                last, marks = rows[-1], [(row[0],) for row in rows]
                self._index.execute("DELETE FROM let_go")
                self._index.execute("INSERT INTO let_go VALUES (?, ?)", (last[0], last[3] or CHAIN_START))
                self._index.executemany("DELETE FROM segments WHERE inspection_id = ?", marks)
                self._index.executemany("DELETE FROM records WHERE inspection_id = ?", marks)
            self._commit(names)
            if not rows:
                break
            after = rows[-1][0]
        return done

    def _begin(self) -> None:
        patiently(lambda: self._index.execute("BEGIN" if self._dry else "BEGIN IMMEDIATE"))

    def _commit(self, names: list[str]) -> None:
        if self._dry:
            self._index.execute("ROLLBACK")
            return
        self._index.executemany("INSERT INTO to_remove VALUES (?)", [(name,) for name in names])
        patiently(lambda: self._index.execute("COMMIT"))
        for name in names:
            self._remove(name)

    def _remove(self, name: str) -> None:
        path = self._folder / name
        path.unlink(missing_ok=True)
        if path.parent.is_dir() and path.parent != self._folder and not any(path.parent.iterdir()):
            path.parent.rmdir()
            sync_folder(self._folder)
        with writing(self._index, self._folder / NAME):
            self._index.execute("DELETE FROM to_remove WHERE name = ?", (name,))


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


class Housekeeping:
    """A thread of the engine that prunes the archive at the start and then every hour."""

    def __init__(self, folder: Path, keep: KeepSettings) -> None:
        self._folder, self._keep = folder, keep
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="housekeeping", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread; a step of pruning in progress is completed."""
        self._stop.set()
        self._thread.join(timeout=10)

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                done = prune(self._folder, self._keep, datetime.now(UTC), stop=self._stop)
                if done.frames or done.records:
                    log.info(
                        "archive pruned: %d frames and %d records deleted, %.1f GB",
                        done.frames,
                        done.records,
                        done.bytes / 1e9,
                    )
            except RecordError as error:
                log.error("%s", error)
            except Exception:  # the thread must survive: without it the disk fills up
                log.exception("the archive could not be pruned")
            self._stop.wait(EVERY_S)

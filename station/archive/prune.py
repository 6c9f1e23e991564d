"""Deletes frames and records after their retention, in small steps so that the engine never waits for it."""

import hashlib
import sqlite3
import threading
from collections.abc import Callable, Iterable
from contextlib import closing, suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from itertools import groupby
from pathlib import Path

from station.archive.age import (
    BACK,
    END,
    STRANGE,
    Clock,
    Jump,
    first_young,
    jumps,
    newest,
    trusted,
    undecided,
)
from station.archive.rows import FRAME_FILE, RECORD_FILE
from station.archive.schema import NAME, read_index
from station.errors import RecordError
from station.files.durable import sync_folder
from station.files.sqlite import CHAIN_START, connect_to_write, writing
from station.settings.model import KeepSettings

CLOCK = Clock()
"""Nothing is known about the clock but the dates themselves."""
STEP = 200
"""Number of records in one transaction."""
GIB = 1 << 30
"""Bytes in a GiB."""

Note = Callable[[str, str, str], None]
"""Function that notes a deletion (what, numbers, rule) before it is done. Raises RecordError."""


@dataclass(frozen=True, slots=True)
class Pruned:
    """Number and size of the frames and records that were deleted, or would be."""

    frames: int = 0
    records: int = 0
    bytes: int = 0
    doubt: str = ""
    """Why nothing was deleted for its age, as the clock is in doubt; empty if it is not."""

    def __add__(self, other: "Pruned") -> "Pruned":
        frames, records = self.frames + other.frames, self.records + other.records
        return Pruned(frames, records, self.bytes + other.bytes, self.doubt or other.doubt)


def prune(
    folder: Path,
    keep: KeepSettings,
    now: datetime,
    *,
    note: Note,
    clock: Clock = CLOCK,
    dry: bool = False,
    stop: threading.Event | None = None,
) -> Pruned:
    """Delete frames and records past their retention, and the oldest frames above the quota.

    With `dry`, nothing is deleted. Nothing is deleted for its age while the clock is in doubt, or if the
    newest record is more than a week old. Each deletion is noted before it is done. Raises RecordError.
    """
    if not (folder / NAME).is_file():
        raise RecordError(f"{folder}: no records found ({NAME} is missing); name an archive folder")
    try:
        with closing(connect_to_write(folder / NAME)) as index:
            work = _Work(folder, index, dry=dry, stop=stop or threading.Event(), note=note)
            work.remove_leftovers()
            found = jumps(index, clock)
            right = trusted(found, clock)
            last = newest(index, right)
            doubt = _doubt(index, undecided(found, clock), right, now=now)
            by_age = not doubt and last is not None and now - last <= STRANGE
            done = Pruned(doubt=doubt)
            for condition, days, rule in _old_frames(keep) if by_age else ():
                limit = first_young(index, now - timedelta(days=days), right)
                done += work.delete_frames(condition, limit, None, rule)
            excess = work.stored_bytes() - keep.quota_gib * GIB
            for condition in ("verdict = 'OK'", "verdict = 'ERROR'", "1"):
                if excess > 0:
                    rule = f"quota_gib = {keep.quota_gib:g}"
                    more = work.delete_frames(condition, END, excess, rule)
                    done, excess = done + more, excess - more.bytes
            if by_age:
                limit = first_young(index, now - timedelta(days=keep.record_days), right)
                done += work.delete_records(limit, f"record_days = {keep.record_days}")
            return done
    except (sqlite3.Error, OSError, ValueError) as error:
        raise RecordError(f"{folder}: could not be pruned ({error})") from None


def find_jumps(folder: Path, clock: Clock) -> list[Jump]:
    """Return the jumps of the dates in an archive. Raises RecordError."""
    with closing(read_index(folder)) as index:
        try:
            return jumps(index, clock)
        except (sqlite3.Error, UnicodeError) as error:
            raise RecordError(f"{folder}: the index cannot be read ({error})") from None


def clock_doubt(folder: Path, now: datetime, clock: Clock) -> str:
    """Return why the clock is in doubt, or an empty text. Raises RecordError."""
    try:
        with closing(read_index(folder)) as index:
            found = jumps(index, clock)
            return _doubt(index, undecided(found, clock), trusted(found, clock), now=now)
    except (sqlite3.Error, ValueError) as error:
        raise RecordError(f"{folder}: the index cannot be read ({error})") from None


def sampled(inspection_id: int, fraction: float) -> bool:
    """Return whether the frame of an OK part is kept longer; depends on nothing but the two arguments."""
    return int.from_bytes(hashlib.sha256(str(inspection_id).encode()).digest()[:4], "big") < fraction * 2**32


def _doubt(index: sqlite3.Connection, open_ones: list[Jump], right: str, *, now: datetime) -> str:
    """Return why the clock is in doubt, or ""; `right`: as from `trusted`."""
    if open_ones:
        more = f" and {len(open_ones) - 1} more" if len(open_ones) > 1 else ""
        return f"the dates jump at {open_ones[0]}{more}"
    last = newest(index, right)
    if last is not None and now < last - BACK:
        return f"the clock says {now:%Y-%m-%d %H:%M}, but the newest record is of {last:%Y-%m-%d %H:%M}"
    wrong = newest(index, f"NOT ({right})")
    if last is not None and wrong is not None and now - last > STRANGE and abs(now - wrong) < STRANGE:
        return f"the clock still says {now:%Y-%m-%d %H:%M}, like the records whose date is wrong"
    return ""


def _old_frames(keep: KeepSettings) -> list[tuple[str, int, str]]:
    """Return conditions on the frames, each with its retention in days and the rule as text."""
    share = float(keep.ok_share)
    return [
        (
            f"verdict = 'OK' AND NOT sampled(inspection_id, {share})",
            keep.ok_all_days,
            f"ok_all_days = {keep.ok_all_days}, ok_share = {share:g}",
        ),
        ("verdict = 'OK'", keep.ok_days, f"ok_days = {keep.ok_days}"),
        ("verdict = 'NOK'", keep.nok_days, f"nok_days = {keep.nok_days}"),
        ("verdict = 'ERROR'", keep.error_days, f"error_days = {keep.error_days}"),
    ]


def as_ranges(numbers: Iterable[int]) -> str:
    """Return ascending numbers as text: 1-3, 5."""
    groups = groupby(enumerate(numbers), lambda pair: pair[1] - pair[0])
    runs = [[number for _, number in group] for _, group in groups]
    return ", ".join(str(run[0]) if len(run) == 1 else f"{run[0]}-{run[-1]}" for run in runs)


class _Work:
    """One run over an index. The names of files are noted before they are deleted, so that an interrupted run
    leaves no files behind."""

    def __init__(
        self, folder: Path, index: sqlite3.Connection, *, dry: bool, stop: threading.Event, note: Note
    ) -> None:
        self._folder, self._index, self._dry, self._stop = folder, index, dry, stop
        self._note = note
        self._deleted: set[int] = set()
        """Numbers of the records whose frames were deleted in this run."""
        index.create_function("sampled", 2, sampled, deterministic=True)

    def remove_leftovers(self) -> None:
        """Delete the files that an interrupted run noted but did not delete."""
        if not self._dry:
            names = [row[0] for row in self._index.execute("SELECT name FROM to_remove")]
            if names:
                self._remove(names)

    def stored_bytes(self) -> int:
        """Return the size of all frames that remain."""
        rows = self._index.execute(
            "SELECT inspection_id, frame_file FROM records "
            "WHERE frame_state = 'kept' AND frame_file IS NOT NULL"
        )
        return sum(_size(self._folder / name) for number, name in rows if number not in self._deleted)

    def delete_frames(self, condition: str, before: int, enough_bytes: float | None, rule: str) -> Pruned:
        """Delete frames of records before a number, the oldest first, until `enough_bytes` are freed."""
        done, after = Pruned(), 0
        query = (
            "SELECT inspection_id, frame_file FROM records "
            "WHERE frame_state = 'kept' AND frame_file IS NOT NULL "
            f"AND inspection_id > ? AND inspection_id < ? AND {condition} ORDER BY 1 LIMIT {STEP}"
        )
        while not self._stop.is_set() and (enough_bytes is None or done.bytes < enough_bytes):
            rows = self._index.execute(query, (after, before)).fetchall()
            if not rows:
                break
            chosen = []
            for number, name in rows:
                after = number
                if number in self._deleted or (enough_bytes is not None and done.bytes >= enough_bytes):
                    continue
                chosen.append((number, name))
                done += Pruned(1, 0, _size(self._folder / name))
            self._deleted |= {number for number, _ in chosen}
            marks = [(number,) for number, _ in chosen]
            if self._dry or not marks:
                continue
            self._note("frames", as_ranges(number for number, _ in chosen), rule)
            with writing(self._index, self._folder / NAME):
                self._index.executemany(
                    "UPDATE records SET frame_state = 'pruned' WHERE inspection_id = ?", marks
                )
                self._plan([name for _, name in chosen])
            self._remove([name for _, name in chosen])
        return done

    def delete_records(self, before: int, rule: str) -> Pruned:
        """Delete the records before a number; the remaining chain starts where theirs ended."""
        done, after = Pruned(), 0
        while not self._stop.is_set():
            rows = self._index.execute(
                "SELECT inspection_id, record_file, frame_file, chain FROM records "
                f"WHERE inspection_id > ? AND inspection_id < ? ORDER BY 1 LIMIT {STEP}",
                (after, before),
            ).fetchall()
            if not rows:
                break
            names = [row[1] for row in rows] + [
                row[2] for row in rows if row[2] is not None and row[0] not in self._deleted
            ]
            done += Pruned(0, len(rows), sum(_size(self._folder / name) for name in names))
            last, marks = rows[-1], [(row[0],) for row in rows]
            after = last[0]
            if self._dry:
                continue
            self._note("records", as_ranges(row[0] for row in rows), rule)
            with writing(self._index, self._folder / NAME):
                self._index.execute("DELETE FROM let_go")
                self._index.execute("INSERT INTO let_go VALUES (?, ?)", (last[0], last[3] or CHAIN_START))
                self._index.executemany("DELETE FROM segments WHERE inspection_id = ?", marks)
                self._index.executemany("DELETE FROM records WHERE inspection_id = ?", marks)
                self._plan(names)
            self._remove(names)
        return done

    def _plan(self, names: list[str]) -> None:
        self._index.executemany("INSERT INTO to_remove VALUES (?)", [(name,) for name in names])

    def _remove(self, names: list[str]) -> None:
        """Delete files, and the folders of days that are empty then; no folder is listed for that."""
        own = [name for name in names if RECORD_FILE.fullmatch(name) or FRAME_FILE.fullmatch(name)]
        for name in own:
            (self._folder / name).unlink(missing_ok=True)
        emptied = False
        for day in sorted({name.partition("/")[0] for name in own}):
            with suppress(OSError):  # it holds other files
                (self._folder / day).rmdir()
                emptied = True
        if emptied:
            sync_folder(self._folder)
        with writing(self._index, self._folder / NAME):
            self._index.executemany("DELETE FROM to_remove WHERE name = ?", [(name,) for name in names])


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0

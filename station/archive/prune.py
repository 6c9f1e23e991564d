"""Lets the oldest go: first pictures by kind of part, then whole records; small steps, so that the engine never waits for it."""

import hashlib
import logging
import sqlite3
import threading
from contextlib import closing
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from station.archive.files import sync_folder
from station.archive.schema import NAME, START
from station.errors import RecordError
from station.settings import KeepSettings

log = logging.getLogger("weldgate.archive")

STEP = 50
"""Records in one transaction."""
EVERY_S = 3600.0
GIB = 1 << 30


@dataclass(frozen=True, slots=True)
class Pruned:
    """What was let go, or would be."""

    frames: int = 0
    records: int = 0
    bytes: int = 0

    def __add__(self, other: "Pruned") -> "Pruned":
        return Pruned(self.frames + other.frames, self.records + other.records, self.bytes + other.bytes)


def prune(folder: Path, keep: KeepSettings, now: datetime, dry: bool = False, stop: threading.Event | None = None) -> Pruned:
    """Let go what is older than `keep` says, and the oldest pictures beyond the quota. Raises RecordError."""
    if not (folder / NAME).is_file():
        raise RecordError(f"{folder}: no records here ({NAME} is missing); name an archive folder")
    stop = stop or threading.Event()
    try:
        with closing(sqlite3.connect(folder / NAME, timeout=5.0)) as index:
            done = Pruned()
            for condition, values in _old_frames(keep, now):
                done += _let_frames_go(folder, index, condition, values, None, dry, stop)
            excess = int(_frame_bytes(folder, index) - (done.bytes if dry else 0) - keep.quota_gib * GIB)
            if excess > 0:
                for condition in ("verdict = 'OK'", "verdict = 'ERROR'", "1"):
                    more = _let_frames_go(folder, index, condition, (), excess, dry, stop)
                    done, excess = done + more, excess - more.bytes
                    if excess <= 0:
                        break
            return done + _let_records_go(folder, index, (now - timedelta(days=keep.record_days)).isoformat(), dry, stop)
    except (sqlite3.Error, OSError) as error:
        raise RecordError(f"{folder}: could not be pruned ({error})") from None


def sampled(inspection_id: int, share: float) -> bool:
    """Whether an OK part is one of those whose picture is kept longer: the same answer for the same number, on any machine."""
    return int.from_bytes(hashlib.sha256(str(inspection_id).encode()).digest()[:4], "big") < share * 2**32


def _old_frames(keep: KeepSettings, now: datetime) -> list[tuple[str, tuple[str, ...]]]:
    ages = (("OK", keep.ok_days), ("NOK", keep.nok_days), ("ERROR", keep.error_days))
    found = [("verdict = ? AND grabbed_at < ?", (verdict, (now - timedelta(days=days)).isoformat())) for verdict, days in ages]
    early = (now - timedelta(days=keep.ok_all_days)).isoformat()
    return [*found, (f"verdict = 'OK' AND grabbed_at < ? AND NOT sampled(inspection_id, {float(keep.ok_share)})", (early,))]


def _let_frames_go(
    folder: Path,
    index: sqlite3.Connection,
    condition: str,
    values: tuple[str, ...],
    enough_bytes: int | None,
    dry: bool,
    stop: threading.Event,
) -> Pruned:
    """Mark a step of pictures as pruned, then remove the files: a stop in between leaves files that the next run removes."""
    index.create_function("sampled", 2, sampled, deterministic=True)
    kept = f"frame_state = 'kept' AND inspection_id > ? AND {condition}"
    query = f"SELECT inspection_id, frame_file FROM records WHERE {kept} ORDER BY 1 LIMIT {STEP}"
    done, after = Pruned(), 0
    while not stop.is_set() and (enough_bytes is None or done.bytes < enough_bytes):
        rows = index.execute(query, (after, *values)).fetchall()
        if not rows:
            break
        chosen = []
        for number, name in rows:
            if enough_bytes is not None and done.bytes >= enough_bytes:
                break
            chosen.append((number, folder / name))
            done += Pruned(1, 0, _size(folder / name))
        after = chosen[-1][0]
        if not dry:
            with index:
                index.executemany("UPDATE records SET frame_state = 'pruned' WHERE inspection_id = ?", [(number,) for number, _ in chosen])
            for _, path in chosen:
                path.unlink(missing_ok=True)
    return done


def _let_records_go(folder: Path, index: sqlite3.Connection, before: str, dry: bool, stop: threading.Event) -> Pruned:
    """The oldest records, as long as they are old: the rest of the chain begins where they end."""
    done, after = Pruned(), 0
    while not stop.is_set():
        rows = index.execute(
            "SELECT inspection_id, record_file, frame_file, chain, grabbed_at < ? FROM records "
            f"WHERE inspection_id > ? ORDER BY 1 LIMIT {STEP}",
            (before, after),
        ).fetchall()
        old = []
        for row in rows:
            if not row[4]:
                break
            old.append(row)
        if not old:
            break
        after = old[-1][0]
        paths = [folder / name for row in old for name in (row[1], row[2]) if name is not None]
        done += Pruned(0, len(old), sum(_size(path) for path in paths))
        if not dry:
            with index:
                index.execute("DELETE FROM let_go")
                index.execute("INSERT INTO let_go VALUES (?, ?)", (after, old[-1][3] or START))
                index.executemany("DELETE FROM segments WHERE inspection_id = ?", [(row[0],) for row in old])
                index.executemany("DELETE FROM records WHERE inspection_id = ?", [(row[0],) for row in old])
            for path in paths:
                path.unlink(missing_ok=True)
            for day in {path.parent for path in paths}:
                if day.is_dir() and not any(day.iterdir()):
                    day.rmdir()
                    sync_folder(folder)
        if len(old) < len(rows) or len(rows) < STEP:
            break
    return done


def _frame_bytes(folder: Path, index: sqlite3.Connection) -> int:
    names = index.execute("SELECT frame_file FROM records WHERE frame_state = 'kept' AND frame_file IS NOT NULL")
    return sum(_size(folder / name) for (name,) in names)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


class Housekeeping:
    """Prunes at the start and every hour in a thread of its own, beside the engine."""

    def __init__(self, folder: Path, keep: KeepSettings) -> None:
        self._folder, self._keep = folder, keep
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="housekeeping", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End; at most one step of pruning is still done."""
        self._stop.set()
        self._thread.join(timeout=10)

    def _run(self) -> None:
        while not self._stop.is_set():
            try:
                done = prune(self._folder, self._keep, datetime.now(UTC), stop=self._stop)
                if done.frames or done.records:
                    log.info("let go: %d pictures, %d records, %.1f GB", done.frames, done.records, done.bytes / 1e9)
            except RecordError as error:
                log.error("%s", error)
            self._stop.wait(EVERY_S)

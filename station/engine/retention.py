"""Deletes what is past its retention, with an entry in the journal; watches the clock meanwhile."""

import logging
import threading
import time
from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from station.archive.age import BACK, Clock, Right
from station.archive.prune import Pruned, clock_doubt, prune
from station.archive.reader import Query, find
from station.engine.check_ins import PRUNING_S, CheckIns
from station.errors import RecordError
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.settings.model import KeepSettings

log = logging.getLogger("weldgate.archive")

EVERY_S = 3600.0
"""Interval of the engine's pruning."""
LOOK_S = 60.0
"""Interval at which the engine compares the clock with the time since its start."""
STEPPED = "the clock was set while the engine was running"
"""Reason of the entry about a step of the clock."""


def read_clock(folder: Path) -> Clock:
    """Return what the journal knows about the clock. Raises RecordError."""
    decisions: dict[int, Right] = {}
    steps: set[int] = set()
    for entry in entries(folder, (Kind.CLOCK,), newest_first=False):
        if not entry.subject.isdecimal():
            continue
        if entry.reason == STEPPED:
            steps.add(int(entry.subject))
        elif entry.after in list(Right):
            decisions[int(entry.subject)] = Right(entry.after)
    return Clock(decisions, frozenset(steps))


def decide(folder: Path, number: int, right: Right, *, who: str) -> None:
    """Write to the journal which dates at the jump before a record are right. Raises RecordError."""
    append(folder, Kind.CLOCK, who, str(number), after=right)


def prune_archive(
    folder: Path,
    keep: KeepSettings,
    *,
    who: str,
    dry: bool = False,
    stop: threading.Event | None = None,
    now: datetime | None = None,
) -> Pruned:
    """Delete what is past its retention; each deletion is in the journal before it is done.

    `who`: user who prunes, or "station". Raises RecordError.
    """

    def note(what: str, numbers: str, rule: str) -> None:
        append(folder, Kind.DELETED, who, what, after=numbers, reason=rule)

    moment = datetime.now(UTC) if now is None else now
    return prune(folder, keep, moment, note=note, clock=read_clock(folder), dry=dry, stop=stop)


def _since_start_s() -> float:
    """Return the time since the start of the machine, in seconds, with the time that it slept."""
    boottime = getattr(time, "CLOCK_BOOTTIME", None)
    return time.monotonic() if boottime is None else time.clock_gettime(boottime)


class Housekeeping:
    """A thread of the engine that prunes the archive at the start and then every hour."""

    def __init__(
        self,
        folder: Path,
        keep: KeepSettings,
        *,
        wall_s: Callable[[], float] = time.time,
        since_start_s: Callable[[], float] = _since_start_s,
        look_s: float = LOOK_S,
        check_ins: CheckIns | None = None,
    ) -> None:
        """`wall_s` and `since_start_s` are the clock and the time since some start, in seconds."""
        self._folder, self._keep, self._look_s = folder, keep, look_s
        self._check_ins = check_ins or CheckIns()
        self._wall_s, self._since_start_s = wall_s, since_start_s
        self._stop = threading.Event()
        self._doubt = ""
        self._thread = threading.Thread(target=self._run, name="housekeeping", daemon=True)
        self._thread.start()

    @property
    def clock_in_doubt(self) -> bool:
        """True while nothing is deleted for its age because the clock is in doubt."""
        return bool(self._doubt)

    def close(self) -> None:
        """End the thread; a step of pruning in progress is completed."""
        self._stop.set()
        self._thread.join(timeout=10)

    def _run(self) -> None:
        offset_s, pruned_s = self._wall_s() - self._since_start_s(), -EVERY_S
        while not self._stop.is_set():
            now_s = self._since_start_s()
            stepped_s = self._wall_s() - now_s - offset_s
            if abs(stepped_s) > BACK.total_seconds() and self._guarded(partial(self._note_step, stepped_s)):
                offset_s += stepped_s
                pruned_s = now_s - EVERY_S
            if now_s - pruned_s >= EVERY_S or self._doubt_is_gone():
                pruned_s = now_s
                self._guarded(self._prune)
            self._stop.wait(self._look_s)

    def _guarded(self, work: Callable[[], None]) -> bool:
        try:
            with self._check_ins.working("housekeeping", PRUNING_S):
                work()
        except RecordError as error:
            log.error("%s", error)
        except Exception:  # the thread must survive: without it the disk fills up
            log.exception("the archive could not be pruned")
        else:
            return True
        return False

    def _doubt_is_gone(self) -> bool:
        """Return whether the clock was in doubt at the last pruning and is no longer."""
        if not self._doubt:
            return False
        try:
            return not clock_doubt(self._folder, datetime.now(UTC), read_clock(self._folder))
        except RecordError as error:
            log.error("%s", error)
            return False

    def _note_step(self, stepped_s: float) -> None:
        """Note a step: the next record is the first after it."""
        last = find(self._folder, Query(newest_first=True, limit=1))
        number = str(last[0].inspection_id + 1) if last else "1"
        step = f"{stepped_s / 3600:+.1f} h"
        append(self._folder, Kind.CLOCK, "station", number, after=step, reason=STEPPED)

    def _prune(self) -> None:
        done = prune_archive(self._folder, self._keep, who="station", stop=self._stop)
        if done.doubt and done.doubt != self._doubt:
            log.error(
                "nothing is deleted for its age: %s. Say which time is right: weldgate records clock",
                done.doubt,
            )
        self._doubt = done.doubt
        if done.frames or done.records:
            log.info(
                "archive pruned: %d frames and %d records deleted, %.1f GB",
                done.frames,
                done.records,
                done.bytes / 1e9,
            )

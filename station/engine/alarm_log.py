"""Writes alarms to the journal when they become active and when they clear; in its own thread."""

import logging
import queue
import threading
from collections.abc import Collection
from pathlib import Path

from station.engine.check_ins import DISK_S, CheckIns
from station.errors import RecordError
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.plc.map.alarms import TEXTS, Alarm

log = logging.getLogger("weldgate.alarms")

MAX_WAITING = 1000
"""Number of entries that wait for a slow disk."""
ENTRIES_READ = 2000
"""Number of newest journal entries that are read at the start."""


class AlarmLog:
    """Journal of active alarms and of events (alarms that do not last)."""

    def __init__(self, folder: Path, check_ins: CheckIns | None = None) -> None:
        """`folder`: the archive; alarms active at the last shutdown stay active until they clear."""
        self._folder, self._check_ins = folder, check_ins or CheckIns()
        self._active = _still_active(folder)
        self._queue: queue.Queue[tuple[Kind, int, str] | None] = queue.Queue(MAX_WAITING)
        self._thread = threading.Thread(target=self._run, name="alarms", daemon=True)
        self._thread.start()

    def set_active(self, codes: Collection[int]) -> None:
        """Take in the codes of all active alarms, at any rate; only changes are written."""
        active = frozenset(codes)
        for code in sorted(active - self._active):
            log.warning("alarm 16#%04X: %s; %s", code, TEXTS[code].cause, TEXTS[code].action)
            self._put(Kind.ALARM, code, "")
        for code in sorted(self._active - active):
            log.info("alarm 16#%04X cleared: %s", code, TEXTS[code].cause)
            self._put(Kind.ALARM_OVER, code, "")
        self._active = active

    def add_event(self, code: int, subject: str) -> None:
        """Note an event that concerned `subject`."""
        self._put(Kind.ALARM, code, subject)

    def _put(self, kind: Kind, code: int, subject: str) -> None:
        try:
            self._queue.put_nowait((kind, code, subject))
        except queue.Full:
            log.error("alarm 16#%04X could not be written to the journal: the disk is too slow", code)

    def close(self) -> None:
        """Write what waits and end the thread."""
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join(timeout=10)

    def _run(self) -> None:
        while (item := self._queue.get()) is not None:
            kind, code, subject = item
            try:
                with self._check_ins.working("alarms", DISK_S):
                    append(self._folder, kind, "station", f"16#{code:04X}", after=subject)
            except RecordError as error:
                log.error("%s", error)


def _still_active(folder: Path) -> frozenset[int]:
    """Return the alarms that the journal shows as active; none, with a log entry, if it cannot be read."""
    found: dict[int, bool] = {}
    try:
        for entry in entries(folder, (Kind.ALARM, Kind.ALARM_OVER), limit=ENTRIES_READ):
            found.setdefault(int(entry.subject.removeprefix("16#"), 16), entry.kind is Kind.ALARM)
    except (RecordError, ValueError) as error:  # parts are judged all the same
        log.error("alarms of the previous run cannot be read: %s", error)
        return frozenset()
    return frozenset(code for code, active in found.items() if active and code in list(Alarm))

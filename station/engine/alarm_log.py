"""Keeps in the journal what raised an alarm and when it was over; from a thread of its own, so that no part waits for it."""

import logging
import queue
import threading
from collections.abc import Collection
from pathlib import Path

from station.errors import RecordError
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.plc.map.alarms import TEXTS, Alarm

log = logging.getLogger("weldgate.alarms")

MAX_WAITING = 1000
LOOKED_AT = 2000
"""Entries of the journal, the newest."""


class AlarmLog:
    """Hears of all alarms that last, as often as one likes, and of each that passes."""

    def __init__(self, folder: Path) -> None:
        """What lasted when the station went down lasts until it is seen to be over."""
        self._folder = folder
        self._last = _open(folder)
        self._queue: queue.Queue[tuple[Kind, int, str] | None] = queue.Queue(MAX_WAITING)
        self._thread = threading.Thread(target=self._run, name="alarms", daemon=True)
        self._thread.start()

    def lasting(self, codes: Collection[int]) -> None:
        """All codes that last now."""
        now = frozenset(codes)
        for code in sorted(now - self._last):
            log.warning("alarm 16#%04X: %s; %s", code, TEXTS[code].cause, TEXTS[code].action)
            self._put(Kind.ALARM, code, "")
        for code in sorted(self._last - now):
            log.info("alarm 16#%04X is over: %s", code, TEXTS[code].cause)
            self._put(Kind.ALARM_OVER, code, "")
        self._last = now

    def passing(self, code: int, what: str) -> None:
        """Something that happened once, to `what`."""
        self._put(Kind.ALARM, code, what)

    def _put(self, kind: Kind, code: int, what: str) -> None:
        try:
            self._queue.put_nowait((kind, code, what))
        except queue.Full:
            log.error("alarm 16#%04X could not be kept: the disk is too slow", code)

    def close(self) -> None:
        """Write what waits, end."""
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join(timeout=10)

    def _run(self) -> None:
        while (item := self._queue.get()) is not None:
            kind, code, what = item
            try:
                append(self._folder, kind, "station", f"16#{code:04X}", after=what)
            except RecordError as error:
                log.error("%s", error)


def _open(folder: Path) -> frozenset[int]:
    """Codes of lasting alarms that the journal tells of and that are not over in it; none, and said, if it cannot be read."""
    found: dict[int, bool] = {}
    try:
        for entry in entries(folder, (Kind.ALARM, Kind.ALARM_OVER), limit=LOOKED_AT):
            found.setdefault(int(entry.subject.removeprefix("16#"), 16), entry.kind is Kind.ALARM)
    except (RecordError, ValueError) as error:  # parts are judged all the same
        log.error("alarms of the run before: %s", error)
        return frozenset()
    return frozenset(code for code, on in found.items() if on and code in list(Alarm))

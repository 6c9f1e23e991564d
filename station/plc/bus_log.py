"""Log of the bus: each change with its time, its author and the rule that it broke; one file per day."""

import json
import logging
import os
import queue
import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

from pydantic import TypeAdapter

from station.errors import RecordError
from station.files.regular import read_regular
from station.plc.map.codes import ERROR_BAD_TRIGGER_ID, ERROR_STUCK_BIT
from station.plc.map.registers import Control, Offline, Status, Value, VerdictCode, named_bits, number

log = logging.getLogger("weldgate.bus")

NAME = "bus-{:%Y-%m-%d}.jsonl"
"""Name of the file of a day."""
WORDS = {
    "command": ("TRIGGER_ID", "COMMAND", "ARG"),
    "status": ("ACK_TRIGGER_ID", "RESULT_TRIGGER_ID", "VERDICT", "CMD_ECHO"),
}
"""Registers of each window, besides CONTROL and STATUS, whose changes are logged."""
MAX_FILE_BYTES = 2_000_000_000
"""Maximum size of the file of a day that is read."""
TAIL_BYTES = 160
"""Approximate length of a line."""
MAX_WAITING = 10_000
"""Number of edges that wait for a slow disk; further ones are left out and counted in the file."""

Values = dict[str, Value]


@dataclass(frozen=True, slots=True)
class Edge:
    """One change on the bus."""

    time: str
    """UTC, ISO 8601 with milliseconds."""
    by: str
    """Author of the change: PLC or station."""
    name: str
    value: int | str
    note: str = field(default="", kw_only=True)
    """How it was cleared, or which rule was broken."""


_EDGE = TypeAdapter(Edge)


def edges(time_s: float, command: tuple[Values, Values], status: tuple[Values, Values]) -> Iterator[Edge]:
    """Yield the changes between two readings (before, after) of both windows at an epoch time."""
    when = datetime.fromtimestamp(time_s, UTC).isoformat(timespec="milliseconds")
    control_before, control = (named_bits(Control, number(values, "CONTROL")) for values in command)
    bits_before, bits = (named_bits(Status, number(values, "STATUS")) for values in status)
    for bit in Control:
        if (control_before ^ control) & bit:
            on = bool(control & bit)
            yield Edge(when, "PLC", str(bit.name), int(on), note=_plc_note(bit, on, bits_before))
    yield from _words(when, "PLC", WORDS["command"], command)
    for flag in Status:
        if (bits_before ^ bits) & flag:
            on = bool(bits & flag)
            note = _station_note(flag, on, control & ~control_before, status[1])
            yield Edge(when, "station", str(flag.name), int(on), note=note)
    yield from _words(when, "station", WORDS["status"], status)
    if status[0]["OFFLINE_REASON"] != status[1]["OFFLINE_REASON"]:
        reason = Offline(number(status[1], "OFFLINE_REASON"))
        note = "PLC_HEARTBEAT does not change" if reason is Offline.PLC_SILENT else ""
        yield Edge(when, "station", "OFFLINE_REASON", reason.name, note=note)


def _words(when: str, by: str, names: tuple[str, ...], windows: tuple[Values, Values]) -> Iterator[Edge]:
    before, after = windows
    for name in names:
        if before.get(name, 0) != after.get(name, 0):
            value = number(after, name) if name in after else 0
            yield Edge(when, by, name, VerdictCode(value).name if name == "VERDICT" else value)


def _plc_note(bit: Control, on: bool, status: Status) -> str:
    if bit is Control.TRIGGER and on and Status.READY not in status:
        return "rule broken: TRIGGER while READY was 0"
    if bit is Control.TRIGGER and not on and Status.TRIGGER_ACK not in status:
        return "rule broken: TRIGGER dropped before TRIGGER_ACK"
    if bit is Control.RESULT_ACK and on and Status.RESULT_VALID not in status:
        return "rule broken: RESULT_ACK without RESULT_VALID"
    return ""


def _station_note(flag: Status, on: bool, rising: Control, after: Values) -> str:
    if flag is Status.MISSED_TRIGGER and on:
        return (
            "rule broken: TRIGGER_ID 0 or repeated"
            if after["ERROR_CODE"] == ERROR_BAD_TRIGGER_ID
            else "TRIGGER not accepted"
        )
    if flag is Status.MAINTENANCE and on:
        stuck = after["ERROR_CODE"] == ERROR_STUCK_BIT
        return (
            "rule broken: TRIGGER or RESULT_ACK held too long"
            if stuck
            else "the station's disk is nearly full"
        )
    if flag is Status.RESULT_VALID and not on:
        if rising & Control.RESULT_ACK:
            return "cleared by RESULT_ACK"
        if rising & Control.TRIGGER:
            return "cleared by the next TRIGGER, not acknowledged"
        return "cleared by the station: too old, offline or link lost, not acknowledged"
    return ""


class BusLog:
    """Writes the changes of both windows, in its own thread so that no disk delays the handshake."""

    def __init__(
        self, folder: Path, days: int, working: Callable[[], AbstractContextManager[None]] = nullcontext
    ) -> None:
        """Files older than `days` are deleted; each writing is a context of `working`.

        Raises RecordError if the folder cannot be used.
        """
        self._folder, self._days, self._working = folder, days, working
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RecordError(
                f"{folder}: the bus log cannot be written ({error.strerror}); set archive.folder"
            ) from None
        self._last: tuple[Values, Values] | None = None
        self._queue: queue.Queue[Edge | None] = queue.Queue(MAX_WAITING)
        self._left_out = 0
        self._day = ""
        self._thread = threading.Thread(target=self._run, name="bus", daemon=True)
        self._thread.start()

    def __call__(self, time_s: float, command: dict[str, Value], status: dict[str, Value]) -> None:
        """Take in both windows as they are now."""
        if self._last is not None:
            for edge in edges(time_s, (self._last[0], command), (self._last[1], status)):
                try:
                    self._queue.put_nowait(edge)
                except queue.Full:
                    self._left_out += 1
        self._last = command, status

    def close(self) -> None:
        """Write what waits and end the thread."""
        if self._thread.is_alive():
            self._queue.put(None)
            self._thread.join(timeout=10)

    def _run(self) -> None:
        ended = False
        while not ended:
            batch = [self._queue.get()]
            while not self._queue.empty():
                batch.append(self._queue.get())
            ended = None in batch
            waiting = [edge for edge in batch if edge is not None]
            try:
                if waiting:
                    with self._working():
                        self._write(waiting)
            except OSError as error:
                self._left_out += len(waiting)
                log.error(
                    "%s: %d edges of the bus log could not be written (%s)",
                    self._folder,
                    len(waiting),
                    error.strerror,
                )

    def _write(self, waiting: list[Edge]) -> None:
        day = waiting[-1].time[:10]
        with (self._folder / f"bus-{day}.jsonl").open("a") as file:
            if self._left_out:
                left_out, why = self._left_out, "the disk was too slow"
                waiting.append(Edge(waiting[-1].time, "station", "EDGES_LEFT_OUT", left_out, note=why))
                self._left_out = 0
            file.writelines(json.dumps(asdict(edge)) + "\n" for edge in waiting)
        if day != self._day:
            self._day = day
            oldest = NAME.format(datetime.now(UTC) - timedelta(days=self._days))
            for path in self._folder.glob("bus-????-??-??.jsonl"):
                if path.name < oldest:
                    path.unlink()


def tail_bus(folder: Path, place: tuple[str, int], limit: int) -> tuple[list[Edge], tuple[str, int]]:
    """Return the edges written since `place` (file name, byte) and the place after them. Raises RecordError.

    `limit`: number of edges at most, of which the newest are returned.
    """
    found: list[Edge] = []
    files = sorted(folder.glob("bus-????-??-??.jsonl"))
    for path in [file for file in files if file.name >= place[0]] if place[0] else files[-1:]:
        start = place[1] if path.name == place[0] else 0
        try:
            with path.open("rb") as file:
                begin = max(start, file.seek(0, os.SEEK_END) - limit * TAIL_BYTES)
                file.seek(begin)
                whole = file.read().rpartition(b"\n")[0]
            lines = whole.split(b"\n")[1 if begin > start else 0 :]
            found += [_EDGE.validate_json(line, strict=True) for line in lines if line]
        except OSError as error:
            raise RecordError(f"{path}: cannot be read ({error.strerror})") from None
        except ValueError:
            raise RecordError(f"{path}: a line cannot be read; the file was truncated or modified") from None
        place = path.name, begin + len(whole) + (1 if whole else 0)
    return found[-limit:], place


def read_bus(folder: Path) -> Iterator[Edge]:
    """Yield all logged edges in order. Raises RecordError if there are none or a line cannot be read."""
    files = sorted(folder.glob("bus-????-??-??.jsonl"))
    if not files:
        raise RecordError(f"{folder}: no bus log in this folder; name the archive folder of an engine")
    for path in files:
        try:
            lines = read_regular(path, MAX_FILE_BYTES).split(b"\n")
        except OSError as error:
            raise RecordError(f"{path}: cannot be read ({error.strerror})") from None
        for count, line in enumerate(lines[:-1] if lines[-1] == b"" else lines, start=1):
            try:
                yield _EDGE.validate_json(line, strict=True)
            except ValueError:
                raise RecordError(
                    f"{path}: line {count} cannot be read; the file was truncated or modified"
                ) from None

"""What went over the bus: each edge with its time, who made it, and what was against the rules, in words; kept in a file a day."""

import json
import logging
import os
import queue
import threading
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime, timedelta
from pathlib import Path

from station.errors import RecordError
from station.plc.map.codes import ERROR_BAD_TRIGGER_ID, ERROR_STUCK_BIT
from station.plc.map.registers import Control, Offline, Status, Value, VerdictCode, named_bits, number

log = logging.getLogger("weldgate.bus")

NAME = "bus-{:%Y-%m-%d}.jsonl"
WORDS = {
    "command": ("TRIGGER_ID", "COMMAND", "ARG"),
    "status": ("ACK_TRIGGER_ID", "RESULT_TRIGGER_ID", "VERDICT", "CMD_ECHO"),
}
TAIL_BYTES = 160
"""About the length of a line."""
MAX_WAITING = 10_000
"""Edges that wait for a slow disk; more are left out, and the file says how many."""

Values = dict[str, Value]


@dataclass(frozen=True, slots=True)
class Edge:
    """One change."""

    time: str
    """UTC, milliseconds."""
    by: str
    """PLC or station."""
    name: str
    value: int | str
    note: str = field(default="", kw_only=True)
    """Who cleared it, or which rule was broken."""


def edges(time_s: float, command: tuple[Values, Values], status: tuple[Values, Values]) -> Iterator[Edge]:
    """Changes between two looks (before, after) at the windows."""
    when = datetime.fromtimestamp(time_s, UTC).isoformat(timespec="milliseconds")
    held, sent = (named_bits(Control, number(values, "CONTROL")) for values in command)
    said, says = (named_bits(Status, number(values, "STATUS")) for values in status)
    for bit in Control:
        if (held ^ sent) & bit:
            on = bool(sent & bit)
            yield Edge(when, "PLC", str(bit.name), int(on), note=_plc_note(bit, on, said))
    yield from _words(when, "PLC", WORDS["command"], command)
    for flag in Status:
        if (said ^ says) & flag:
            on = bool(says & flag)
            note = _station_note(flag, on, sent & ~held, status[1])
            yield Edge(when, "station", str(flag.name), int(on), note=note)
    yield from _words(when, "station", WORDS["status"], status)
    if status[0]["OFFLINE_REASON"] != status[1]["OFFLINE_REASON"]:
        reason = Offline(number(status[1], "OFFLINE_REASON"))
        note = "PLC_HEARTBEAT stands still" if reason is Offline.PLC_SILENT else ""
        yield Edge(when, "station", "OFFLINE_REASON", reason.name, note=note)


def _words(when: str, by: str, names: tuple[str, ...], windows: tuple[Values, Values]) -> Iterator[Edge]:
    before, after = windows
    for name in names:
        if before.get(name, 0) != after.get(name, 0):
            value = number(after, name) if name in after else 0
            yield Edge(when, by, name, VerdictCode(value).name if name == "VERDICT" else value)


def _plc_note(bit: Control, on: bool, said: Status) -> str:
    if bit is Control.TRIGGER and on and Status.READY not in said:
        return "rule broken: TRIGGER while READY was 0"
    if bit is Control.TRIGGER and not on and Status.TRIGGER_ACK not in said:
        return "rule broken: TRIGGER dropped before TRIGGER_ACK"
    if bit is Control.RESULT_ACK and on and Status.RESULT_VALID not in said:
        return "rule broken: RESULT_ACK without RESULT_VALID"
    return ""


def _station_note(flag: Status, on: bool, rising: Control, after: Values) -> str:
    if flag is Status.MISSED_TRIGGER and on:
        return (
            "rule broken: TRIGGER_ID 0 or repeated"
            if after["ERROR_CODE"] == ERROR_BAD_TRIGGER_ID
            else "TRIGGER not taken"
        )
    if flag is Status.MAINTENANCE and on:
        stuck = after["ERROR_CODE"] == ERROR_STUCK_BIT
        return "rule broken: TRIGGER or RESULT_ACK held too long" if stuck else "the station's disk fills"
    if flag is Status.RESULT_VALID and not on:
        if rising & Control.RESULT_ACK:
            return "cleared by RESULT_ACK"
        if rising & Control.TRIGGER:
            return "cleared by the next TRIGGER, not acknowledged"
        return "cleared by the station: too old, offline or link lost, not acknowledged"
    return ""


class BusLog:
    """Hears the line, writes edges to the folder from a thread of its own: a slow disk never holds up the handshake."""

    def __init__(self, folder: Path, days: int) -> None:
        """Files older than `days` are removed. Raises RecordError if the folder cannot be used."""
        self._folder, self._days = folder, days
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise RecordError(
                f"{folder}: the bus cannot be recorded there ({error.strerror}); set archive.folder"
            ) from None
        self._last: tuple[Values, Values] | None = None
        self._queue: queue.Queue[Edge | None] = queue.Queue(MAX_WAITING)
        self._left_out = 0
        self._day = ""
        self._thread = threading.Thread(target=self._run, name="bus", daemon=True)
        self._thread.start()

    def __call__(self, time_s: float, command: dict[str, Value], status: dict[str, Value]) -> None:
        """Both windows as they are now."""
        if self._last is not None:
            for edge in edges(time_s, (self._last[0], command), (self._last[1], status)):
                try:
                    self._queue.put_nowait(edge)
                except queue.Full:
                    self._left_out += 1
        self._last = command, status

    def close(self) -> None:
        """Write what waits, end."""
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
                    self._write(waiting)
            except OSError as error:
                self._left_out += len(waiting)
                log.error(
                    "%s: %d edges of the bus could not be written (%s)",
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


def tail_bus(folder: Path, place: tuple[str, int], most: int) -> tuple[list[Edge], tuple[str, int]]:
    """Edges written since `place` (file name, byte), at most the newest, and the place after them. Raises RecordError."""
    found: list[Edge] = []
    files = sorted(folder.glob("bus-????-??-??.jsonl"))
    for path in [file for file in files if file.name >= place[0]] if place[0] else files[-1:]:
        begun = place[1] if path.name == place[0] else 0
        try:
            with path.open("rb") as file:
                begin = max(begun, file.seek(0, os.SEEK_END) - most * TAIL_BYTES)
                file.seek(begin)
                whole = file.read().rpartition(b"\n")[0]
            lines = whole.split(b"\n")[1 if begin > begun else 0 :]
            found += [Edge(**json.loads(line)) for line in lines if line]
        except OSError as error:
            raise RecordError(f"{path}: cannot be read ({error.strerror})") from None
        except (ValueError, TypeError):
            raise RecordError(f"{path}: a line cannot be read; the file was cut off or changed") from None
        place = path.name, begin + len(whole) + (1 if whole else 0)
    return found[-most:], place


def read_bus(folder: Path) -> Iterator[Edge]:
    """All recorded edges in order. Raises RecordError if there are none, or a line cannot be read."""
    files = sorted(folder.glob("bus-????-??-??.jsonl"))
    if not files:
        raise RecordError(
            f"{folder}: no record of the bus here; name an archive folder of an engine that ran"
        )
    for path in files:
        for count, line in enumerate(path.read_text().splitlines(), start=1):
            try:
                yield Edge(**json.loads(line))
            except (ValueError, TypeError):
                raise RecordError(
                    f"{path}: line {count} cannot be read; the file was cut off or changed"
                ) from None

"""`Line` over Modbus, as server or client: one thread, whose loop steps the handshake and uses the wire."""

import asyncio
import logging
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress

from station.errors import LineError
from station.plc.handshake import step
from station.plc.handshake_state import ALL_CONTROL, Inputs, Phase, State, Step, Times
from station.plc.map import status_window
from station.plc.map.registers import (
    BY_NAME,
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    CommandCode,
    Control,
    Offline,
    Value,
    VerdictCode,
    named_bits,
    number,
    pack_window,
    unpack_window,
)
from station.plc.port import Command, Counts, Health, LineState, Result, Trigger
from station.plc.wire.windows import WAITING, Wire, make_wire
from station.settings.model import PlcSettings

log = logging.getLogger("weldgate.line")

SERIAL = BY_NAME["PART_SERIAL"]
"""Register whose words are echoed."""
GRACE_S = 2.0
"""Longest interruption of the link that does not end the part in progress."""
ANSWER_S = 5.0
"""Time after the deadline within which it is known whether a published result was shown."""

Offer = tuple[Result, "Future[bool]"]
"""Result offered for publication, and the future that learns whether the PLC could read it."""
Bus = Callable[[float, dict[str, Value], dict[str, Value]], None]
"""Function called after every step with the epoch time, the command window and the status window."""
NO_BUS: Bus = lambda _time, _command, _status: None  # noqa: E731


def make_line(
    settings: PlcSettings, bus: Bus = NO_BUS, alive: Callable[[], None] = lambda: None
) -> "ModbusLine":
    """Return the line that the settings describe, not yet started. Raises SettingsError."""
    times = Times(
        deadline_s=settings.deadline_ms / 1000,
        result_ttl_s=settings.result_ttl_ms / 1000,
        stuck_s=settings.stuck_ms / 1000,
        plc_heartbeat_s=settings.plc_heartbeat_ms / 1000,
    )
    return ModbusLine(make_wire(settings), times, bus, alive)


class ModbusLine:
    """The station's side of the handshake, over Modbus."""

    def __init__(
        self, wire: Wire, times: Times, bus: Bus = NO_BUS, alive: Callable[[], None] = lambda: None
    ) -> None:
        """`alive` is called before every step: the thread does not hang."""
        self._wire, self._times, self._bus, self._alive = wire, times, bus, alive
        self._requests: queue.SimpleQueue[Trigger | Command] = queue.SimpleQueue()
        self._state = State()
        self._health = Health(ready=False, offline=Offline.STARTING, failure=False, config_crc=0)
        self._health_s = -1e9
        self._counts = {VerdictCode.OK: 0, VerdictCode.NOK: 0, VerdictCode.ERROR: 0}
        self._command_words = [int(ALL_CONTROL)] + [0] * (COMMAND_WORDS - 1)
        self._command = unpack_window(COMMAND_START, self._command_words)
        self._exposed: int | None = None
        self._offered: Offer | None = None
        self._done: tuple[int, bool] | None = None
        self._after: list[Callable[[], None]] = []
        """Actions to take once the PLC can read the outcome of the step."""
        self._lost_s: float | None = None
        self._lost_reported = ""
        self._published = self._values(0.0)
        self._status_words = pack_window(STATUS_START, STATUS_WORDS, self._published)
        """Words of the status window as last published."""
        self._loop: asyncio.AbstractEventLoop | None = None
        self._thread: threading.Thread | None = None
        self._wake: asyncio.Event | None = None
        self._stopping = False

    @property
    def port(self) -> int:
        """TCP port in use."""
        return self._wire.port

    def start(self) -> None:
        """Listen, or begin to connect to the PLC. Raises LineError."""
        started: Future[None] = Future()
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._run(started)), name="modbus", daemon=True
        )
        self._thread.start()
        try:
            started.result(timeout=10)
        except LineError:
            self._thread.join(timeout=5)
            self._thread = self._loop = None
            raise

    def stop(self) -> None:
        """Wipe the record, close the connections and end the thread."""
        if self._thread is None:
            return
        self._stopping = True
        with suppress(LineError):
            self._wake_loop()
        self._thread.join(timeout=10)
        self._thread = None

    def next_request(self, timeout_s: float) -> Trigger | Command | None:
        """Return the next accepted trigger or command; None if none came in time."""
        try:
            return self._requests.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def awaits_result(self, trigger: Trigger) -> bool:
        """Return whether this trigger still waits for its result."""
        return self._state.trigger is not None and self._state.trigger.number == trigger.number

    def exposure_done(self, trigger: Trigger) -> None:
        """Report that the image is taken: the part may move."""
        self._exposed = trigger.number
        self._wake_loop()

    def command_done(self, command: Command, succeeded: bool) -> None:
        """Report that a command was carried out, or failed."""
        self._done = (command.number, succeeded)
        self._wake_loop()

    def awaits_command(self, command: Command) -> bool:
        """Return whether this command still waits to be carried out."""
        return self._state.command is not None and self._state.command.number == command.number

    def publish(self, result: Result) -> bool:
        """Publish a result; return True once the PLC can read it, False if it was too late or may be lost."""
        shown: Future[bool] = Future()
        self._offered = (result, shown)
        self._wake_loop()
        try:
            return shown.result(timeout=self._times.deadline_s + ANSWER_S)
        except TimeoutError:  # the link was down until the deadline had passed
            return False

    def check_in(self, health: Health) -> None:
        """Report that the inspection is alive, and its health. Raises LineError."""
        if self._loop is None or self._loop.is_closed():
            raise LineError("the Modbus line is not running")
        self._health, self._health_s = health, time.monotonic()

    def reset_counts(self) -> None:
        """Set the counters back to 0."""
        self._counts = dict.fromkeys(self._counts, 0)

    def state(self) -> LineState:
        """Return what the line reads and publishes now, decoded."""
        return status_window.decoded(self._command, self._published)

    def windows(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Return the words of the command window as last read and of the status window as last published."""
        return tuple(self._command_words), tuple(self._status_words)

    def _wake_loop(self) -> None:
        if self._loop is None or self._loop.is_closed():
            raise LineError("the Modbus line is not running")
        if self._wake is not None:
            with suppress(RuntimeError):  # the loop may have ended meanwhile
                self._loop.call_soon_threadsafe(self._wake.set)

    async def _run(self, started: "Future[None]") -> None:
        self._loop, self._wake = asyncio.get_running_loop(), asyncio.Event()
        try:
            await self._wire.open(self._wake.set)
            await self._step()
        except LineError as error:
            started.set_exception(error)
            return
        started.set_result(None)
        try:
            while not self._stopping:
                self._alive()
                self._wake.clear()
                while await self._step():
                    pass
                try:
                    await asyncio.wait_for(self._wake.wait(), self._wire.tick_s)
                except TimeoutError:
                    continue
        finally:
            await self._wire.close()

    async def _step(self) -> bool:
        """Read, step, publish the whole record, then act; return whether to step again at once."""
        now_s, link = time.monotonic(), True
        try:
            self._command_words = await self._wire.read_command()
            self._command = unpack_window(COMMAND_START, self._command_words)
        except LineError as error:
            link = False
            self._link_lost(error, now_s)
        grace_s = min(self._times.plc_heartbeat_s or GRACE_S, GRACE_S)
        if self._lost_s is not None and not link and now_s - self._lost_s < grace_s:
            return False
        # taken once: the cycle may offer the next one at any time
        offered, self._offered = self._offered, None
        inputs = self._inputs(now_s, link, None if offered is None else offered[0])
        outcome = step(self._state, inputs, now_s, self._times)
        self._count(outcome.state)
        self._state = outcome.state
        self._plan(outcome, offered)
        values = self._values(now_s)
        words = pack_window(STATUS_START, STATUS_WORDS, values)
        if link:
            try:
                await self._wire.publish(words)
            except LineError as error:
                self._link_lost(error, now_s)
                self._bus(time.time(), self._command, self._published)
                return False
            self._lost_s = None
        self._published, self._status_words = values, words
        self._bus(time.time(), self._command, values)
        after, self._after = self._after, []
        for act in after:
            act()
        return outcome.again

    def _inputs(self, now_s: float, link: bool, result: Result | None) -> Inputs:
        command = self._command
        exposed, self._exposed = self._exposed, None
        done, self._done = self._done, None
        return Inputs(
            control=named_bits(Control, number(command, "CONTROL")),
            plc_heartbeat=number(command, "PLC_HEARTBEAT"),
            trigger_id=number(command, "TRIGGER_ID"),
            serial=str(command["PART_SERIAL"]),
            serial_words=tuple(self._command_words[SERIAL.address - COMMAND_START :][: SERIAL.words]),
            command=number(command, "COMMAND"),
            health=self._health,
            health_age_s=now_s - self._health_s,
            exposure_done_for=exposed,
            result=result,
            arg=number(command, "ARG"),
            plc_time_s=number(command, "PLC_TIME"),
            command_done=done,
            link=link,
            link_was_lost=self._lost_s is not None,
        )

    def _plan(self, outcome: Step, offered: "Offer | None") -> None:
        if offered is not None:
            result, shown = offered
            self._after.append(lambda: shown.set_result(not outcome.refused and self._state.result is result))
        if outcome.start is not None:
            start = outcome.start
            self._after.append(lambda: self._requests.put(start))
        if outcome.command is not None:
            self._carry_out(outcome.command)

    def _carry_out(self, command: Command) -> None:
        """Carry out a command that the line can do itself; pass the others to the cycle."""
        if command.code is CommandCode.RESET_COUNTERS:
            self.reset_counts()
        elif command.code is CommandCode.TIME_SYNC:
            plc_s = number(self._command, "PLC_TIME")
            log.info("the PLC's clock differs from the station's by %+.1f s", plc_s - time.time())
        else:
            self._after.append(lambda: self._requests.put(command))

    def _count(self, after: State) -> None:
        if after.phase is Phase.SHOWN and self._state.phase is Phase.BUSY and after.result is not None:
            verdict = after.result.verdict
            if verdict in self._counts:
                self._counts[verdict] += 1

    def _values(self, now_s: float) -> dict[str, Value]:
        by_verdict = self._counts  # another thread may replace it
        counts = Counts(*(by_verdict[code] for code in (VerdictCode.OK, VerdictCode.NOK, VerdictCode.ERROR)))
        return status_window.values(self._state, self._health, now_s, counts)

    def _link_lost(self, error: LineError, now_s: float) -> None:
        if self._lost_s is None:
            self._lost_s, self._lost_reported = now_s, ""
        if str(error) not in (WAITING, self._lost_reported):
            self._lost_reported = str(error)
            log.warning("PLC: %s", error)

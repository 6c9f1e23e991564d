"""Modbus TCP, server for the station and client for a line; the only file that imports pymodbus.

The server's memory is touched from its own loop alone, and a record is written in one call: no reader sees half of one.
"""

import asyncio
import logging
import queue
import threading
import time
from collections.abc import Coroutine
from concurrent.futures import Future
from contextlib import suppress
from typing import Any, TypeVar

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.constants import ExcCodes
from pymodbus.exceptions import ModbusException
from pymodbus.pdu.device import ModbusDeviceIdentification
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from station import __version__
from station.errors import LineError
from station.plc import status_window
from station.plc.handshake import Inputs, Phase, State, Step, Times, step
from station.plc.port import Health, Result, Trigger
from station.plc.registers import (
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    Control,
    Offline,
    VerdictCode,
    number,
    pack_window,
    unpack_window,
)
from station.settings import PlcSettings

Answer = TypeVar("Answer")

TICK_S = 0.01
READ, WRITE = 3, 4
"""Function codes for the application's own access; 4 can never be a client's write."""
CLIENT_WRITES = frozenset((5, 6, 15, 16, 22, 23))

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)


class ModbusServerLine:
    """`Line` as a Modbus TCP server: the PLC is the client. Runs in a thread of its own."""

    def __init__(self, settings: PlcSettings) -> None:
        self._settings = settings
        self._times = Times(
            deadline_s=settings.deadline_ms / 1000,
            result_ttl_s=settings.result_ttl_ms / 1000,
            stuck_s=settings.stuck_ms / 1000,
            plc_heartbeat_s=settings.plc_heartbeat_ms / 1000,
        )
        self._triggers: queue.SimpleQueue[Trigger] = queue.SimpleQueue()
        self._state = State()
        self._health = Health(False, Offline.STARTING, False, 0)
        self._health_s = -1e9
        self._counts = {VerdictCode.OK: 0, VerdictCode.NOK: 0, VerdictCode.ERROR: 0}
        self._published: dict[str, int] = {"STATUS": 0, "OFFLINE_REASON": int(Offline.STARTING), "HEARTBEAT": 0}
        self._loop: asyncio.AbstractEventLoop | None = None
        self._server: ModbusTcpServer | None = None
        self._thread: threading.Thread | None = None
        self._wake: asyncio.Event | None = None
        self._lock: asyncio.Lock | None = None
        self._stopping = False
        self.port = settings.port

    def start(self) -> None:
        """Listen. Raises LineError if the port cannot be had."""
        up: Future[None] = Future()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._run(up)), name="modbus", daemon=True)
        self._thread.start()
        try:
            up.result(timeout=10)
        except (OSError, RuntimeError, ModbusException) as error:
            self._thread.join(timeout=5)
            self._thread = self._loop = None
            raise LineError(
                f"Modbus server cannot listen on {self._settings.host}:{self._settings.port} ({error}); free the port or set plc.port"
            ) from None

    def stop(self) -> None:
        """Wipe the record, close the connections, end the thread."""
        if self._thread is None or self._loop is None:
            return
        self._stopping = True
        if self._wake is not None and not self._loop.is_closed():
            with suppress(RuntimeError):  # the loop may end in between
                self._loop.call_soon_threadsafe(self._wake.set)
        self._thread.join(timeout=5)

    def next_trigger(self, timeout_s: float) -> Trigger | None:
        """The next accepted trigger, or None."""
        try:
            return self._triggers.get(timeout=timeout_s)
        except queue.Empty:
            return None

    def in_work(self, trigger: Trigger) -> bool:
        """Whether this trigger still waits for its answer."""
        return self._state.trigger is not None and self._state.trigger.number == trigger.number

    def exposure_done(self, trigger: Trigger) -> None:
        """The picture is taken: the part may move."""
        self._call(self._step(exposure_done_for=trigger.number))

    def publish(self, result: Result) -> bool:
        """Offer a result; returns once it is readable. False if it came too late and was not shown."""
        return not self._call(self._step(result=result)).refused

    def checked_in(self, health: Health) -> None:
        """The inspection is alive."""
        self._call(self._check_in(health))

    def status(self) -> dict[str, int]:
        """STATUS, OFFLINE_REASON and HEARTBEAT as last published."""
        return dict(self._published)

    def _call(self, coroutine: Coroutine[Any, Any, Answer]) -> Answer:
        if self._loop is None or self._loop.is_closed():
            coroutine.close()
            raise LineError("the Modbus server is not running")
        try:
            return asyncio.run_coroutine_threadsafe(coroutine, self._loop).result(timeout=5)
        except TimeoutError:
            raise LineError("the Modbus server does not answer") from None

    async def _run(self, up: "Future[None]") -> None:
        self._loop = asyncio.get_running_loop()
        self._wake, self._lock = asyncio.Event(), asyncio.Lock()
        identity = ModbusDeviceIdentification(  # type: ignore[no-untyped-call]
            info_name={"VendorName": "weldgate", "ProductCode": "WG", "ProductName": "weldgate", "MajorMinorRevision": __version__}
        )
        device = SimDevice(
            id=0,
            simdata=[SimData(0, count=STATUS_START + STATUS_WORDS, datatype=DataType.REGISTERS)],
            use_bit_addressing=True,
            identity=identity,
            action=self._gate,
        )
        try:
            self._server = ModbusTcpServer(device, identity=identity, address=(self._settings.host, self._settings.port))
            await self._server.serve_forever(background=True)
            sockets = getattr(self._server.transport, "sockets", ())
            self.port = sockets[0].getsockname()[1] if sockets else self._settings.port
            await self._step()
        except (OSError, RuntimeError, ModbusException) as error:
            up.set_exception(error)
            return
        up.set_result(None)
        try:
            while not self._stopping:
                self._wake.clear()
                await self._step()
                try:
                    await asyncio.wait_for(self._wake.wait(), TICK_S)
                except TimeoutError:
                    continue
        finally:
            await self._server.async_setValues(1, WRITE, STATUS_START, [0] * STATUS_WORDS)
            await self._server.shutdown()  # type: ignore[no-untyped-call]

    async def _gate(
        self, function: int, _start: int, address: int, count: int, _current: list[int], values: list[int] | list[bool] | None
    ) -> ExcCodes | None:
        """Clients may write the command window only; each write wakes the handshake."""
        if function not in CLIENT_WRITES or values is None:
            return None
        first = address // 16 if function in (5, 15) else address
        end = first + count  # pymodbus counts registers here, for bits too
        if end > COMMAND_START + COMMAND_WORDS:
            return ExcCodes.ILLEGAL_ADDRESS
        if self._wake is not None:
            asyncio.get_running_loop().call_soon(self._wake.set)
        return None

    async def _check_in(self, health: Health) -> None:
        self._health, self._health_s = health, time.monotonic()

    async def _step(self, exposure_done_for: int | None = None, result: Result | None = None) -> Step:
        """One step, and a second one at once if the first asks for it; never two at a time."""
        if self._lock is None or self._server is None:
            raise LineError("the Modbus server is not running")
        async with self._lock:
            outcome = await self._step_once(self._server, exposure_done_for, result)
            if outcome.again:
                await self._step_once(self._server)
            return outcome

    async def _step_once(self, server: ModbusTcpServer, exposure_done_for: int | None = None, result: Result | None = None) -> Step:
        """Read the command window, step, publish the whole record in one call, then act."""
        words = await server.async_getValues(1, READ, COMMAND_START, COMMAND_WORDS)
        command = unpack_window(COMMAND_START, [int(w) for w in words])
        now_s = time.monotonic()
        inputs = Inputs(
            control=Control(number(command, "CONTROL") & 0xFF),
            plc_heartbeat=number(command, "PLC_HEARTBEAT"),
            trigger_id=number(command, "TRIGGER_ID"),
            serial=str(command["PART_SERIAL"]),
            command=number(command, "COMMAND"),
            health=self._health,
            health_age_s=now_s - self._health_s,
            exposure_done_for=exposure_done_for,
            result=result,
        )
        before = self._state.phase
        outcome = step(self._state, inputs, now_s, self._times)
        self._state = outcome.state
        if outcome.state.phase is Phase.SHOWN and before is Phase.BUSY and outcome.state.result is not None:
            shown = outcome.state.result.verdict
            if shown in self._counts:
                self._counts[shown] += 1
        await self._publish(server, now_s)
        if outcome.start is not None:
            self._triggers.put(outcome.start)
        return outcome

    async def _publish(self, server: ModbusTcpServer, now_s: float) -> None:
        counts = (self._counts[VerdictCode.OK], self._counts[VerdictCode.NOK], self._counts[VerdictCode.ERROR])
        values = status_window.values(self._state, self._health, now_s, counts)
        await server.async_setValues(1, WRITE, STATUS_START, pack_window(STATUS_START, STATUS_WORDS, values))
        self._published = {name: number(values, name) for name in self._published}


class ModbusClient:
    """The PLC's side of the wire: reads the status window, writes the command window."""

    def __init__(self, host: str, port: int) -> None:
        self._address = f"{host}:{port}"
        self._client = AsyncModbusTcpClient(host, port=port, timeout=1.0, retries=0, reconnect_delay=0)

    async def connect(self) -> None:
        """Raises LineError if nobody answers."""
        if not await self._client.connect():
            raise LineError(f"no Modbus server at {self._address}; is the engine running?")

    async def read_status(self) -> list[int]:
        """The whole status window, 76 words, in one read. Raises LineError."""
        try:
            answer = await self._client.read_holding_registers(STATUS_START, count=STATUS_WORDS)
        except ModbusException as error:
            raise LineError(f"{self._address}: {error}") from None
        if answer.isError() or len(answer.registers) != STATUS_WORDS:
            raise LineError(f"{self._address}: read refused: {answer}")
        return list(answer.registers)

    async def write_command(self, address: int, words: list[int]) -> None:
        """Write into the command window. Raises LineError."""
        try:
            answer = await self._client.write_registers(address, words)
        except ModbusException as error:
            raise LineError(f"{self._address}: {error}") from None
        if answer.isError():
            raise LineError(f"{self._address}: write refused: {answer}")

    def close(self) -> None:
        """Drop the connection."""
        self._client.close()

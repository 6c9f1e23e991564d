"""The two windows on the wire: in the station's memory (server) or in the memory of the PLC (client)."""

import logging
import time
from collections.abc import Callable
from typing import Protocol

from station.errors import LineError
from station.plc.map.registers import (
    BY_NAME,
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    Status,
    reordered,
)
from station.plc.wire.access import Access, open_to_all
from station.plc.wire.modbus import ModbusClient, ModbusServer
from station.plc.wire.s7 import S7Client
from station.plc.wire.tls import Tls, client_context, server_context
from station.settings.model import PlcSettings

log = logging.getLogger("weldgate.line")

RESULT_BITS = int(Status.RESULT_VALID | Status.OK | Status.NOK)
"""Bits of STATUS that show a result."""
HEAD = BY_NAME["SEQ_HEAD"].address - STATUS_START
"""Position of SEQ_HEAD in the status window."""
AGE = BY_NAME["RESULT_AGE_10MS"].address - STATUS_START
"""Position of RESULT_AGE_10MS in the status window."""
RETRY_S = 0.5
"""Shortest time between two attempts to connect."""
WAITING = "waiting to connect again"
"""Message of the error between two attempts."""


class Wire(Protocol):
    """Transport of the two windows. Use from one loop only."""

    @property
    def port(self) -> int:
        """Port in use."""

    @property
    def tick_s(self) -> float:
        """Time between two reads of the command window."""

    async def open(self, wake: Callable[[], None]) -> None:
        """Start; `wake` is called when there may be something new. Raises LineError if it can never work."""

    async def close(self) -> None:
        """Wipe the result and stop."""

    async def read_command(self) -> list[int]:
        """Return the command window, taken in one read. Raises LineError if the PLC does not answer."""

    async def publish(self, words: list[int]) -> None:
        """Write the status window so that no reader mistakes half a record for a whole one.

        Raises LineError; then it is unknown what the PLC has.
        """


class Words(Protocol):
    """Words in the memory of a PLC. Use from one loop only."""

    async def connect(self) -> None:
        """Open a new connection. Raises LineError."""

    async def read(self, address: int, count: int, function: int = 3) -> list[int]:
        """Return words, taken in one read. Raises LineError."""

    async def write(self, address: int, words: list[int]) -> None:
        """Write words at once. Raises LineError; then it is unknown whether the PLC has them."""

    def close(self) -> None:
        """Close the connection."""


class ServerWire:
    """Windows in the station's own memory; the PLC is the client."""

    tick_s = 0.01

    def __init__(
        self,
        host: str,
        port: int,
        *,
        access: Access,
        low_word_first: bool,
        tls: Tls,
    ) -> None:
        self._low_word_first = low_word_first
        self._open_to_all = open_to_all(host, access.allow)
        self._wake: Callable[[], None] = lambda: None
        self._server = ModbusServer(
            host,
            port,
            words=STATUS_START + STATUS_WORDS,
            writable=range(COMMAND_START, COMMAND_START + COMMAND_WORDS),
            on_write=lambda: self._wake(),
            access=access,
            tls=tls,
        )

    @property
    def port(self) -> int:
        """Port in use."""
        return self._server.port

    async def open(self, wake: Callable[[], None]) -> None:
        """Listen. Raises LineError if the port cannot be used."""
        self._wake = wake
        await self._server.start()
        if self._open_to_all:
            log.warning(self._open_to_all)

    async def close(self) -> None:
        """Set all registers to 0 and stop."""
        await self._server.stop()

    async def read_command(self) -> list[int]:
        """Return the command window."""
        words = await self._server.read(COMMAND_START, COMMAND_WORDS)
        return reordered(COMMAND_START, words) if self._low_word_first else words

    async def publish(self, words: list[int]) -> None:
        """Write the whole status window in one call."""
        await self._server.write(
            STATUS_START, reordered(STATUS_START, words) if self._low_word_first else words
        )


class ClientWire:
    """Windows in the memory of the PLC, which is the server.

    Its memory keeps what was written last, so the old result is wiped before anything else.
    """

    def __init__(
        self,
        client: Words,
        *,
        port: int,
        bases: tuple[int, int],
        command_function: int,
        poll_s: float,
        low_word_first: bool,
    ) -> None:
        """`bases`: addresses of the command window and of the status window in the PLC.

        `command_function`: function of Modbus that reads the command window, 3 or 4.
        """
        self._client = client
        self.port, self.tick_s = port, poll_s
        self._command_base, self._status_base = bases
        self._command_function = command_function
        self._low_word_first = low_word_first
        self._written: list[int] | None = None
        """Status window as the PLC has it; None if unknown."""
        self._connected = False
        self._tried_s = -1e9

    async def open(self, wake: Callable[[], None]) -> None:
        """Do nothing: the connection is made when it is first needed."""

    async def close(self) -> None:
        """Wipe the result and close the connection."""
        if self._connected:
            try:
                await self._invalidate()
            except LineError:
                pass  # the watchdog of the PLC notices that the heartbeat stops
        self._client.close()
        self._connected = False

    async def read_command(self) -> list[int]:
        """Return the command window; connect and wipe the status window first if needed. Raises LineError."""
        if not self._connected:
            await self._connect()
        try:
            words = await self._client.read(self._command_base, COMMAND_WORDS, self._command_function)
        except LineError:
            self._lost()
            raise
        return reordered(COMMAND_START, words) if self._low_word_first else words

    async def publish(self, words: list[int]) -> None:
        """Write the record, then STATUS, whose bits make it valid. Raises LineError.

        Before another record, all bits of STATUS that no longer hold are cleared.
        """
        if self._low_word_first:
            words = reordered(STATUS_START, words)
        before = self._written
        if before is not None and _without_age(before) == _without_age(words):
            return
        try:
            if before is not None and before[HEAD] != words[HEAD] and before[0] & RESULT_BITS:
                await self._write_status(
                    [before[0] & words[0] & ~RESULT_BITS]
                )  # READY must not outlive the result
            if before is None or before[1:] != words[1:]:
                await self._write_record(words)
            if before is None or before[0] != words[0]:
                await self._write_status(words[:1])
        except LineError:
            self._lost()
            raise
        self._written = list(words)

    async def _connect(self) -> None:
        now_s = time.monotonic()
        if now_s - self._tried_s < RETRY_S:
            raise LineError(WAITING)
        self._tried_s = now_s
        await self._client.connect()
        try:
            await self._invalidate()
        except LineError:
            self._lost()
            raise
        self._connected = True

    async def _invalidate(self) -> None:
        await self._write_status([0])
        await self._write_record([0] * STATUS_WORDS)

    def _lost(self) -> None:
        self._client.close()
        self._connected, self._written = False, None

    async def _write_status(self, word: list[int]) -> None:
        await self._client.write(self._status_base, word)

    async def _write_record(self, words: list[int]) -> None:
        await self._client.write(self._status_base + 1, words[1:])


def _without_age(words: list[int]) -> list[int]:
    return [*words[:AGE], *words[AGE + 1 :]]


def make_wire(settings: PlcSettings) -> Wire:
    """Return the wire that the settings describe, not yet open. Raises SettingsError."""
    if settings.mode == "server":
        return ServerWire(
            settings.host,
            settings.port,
            access=Access(
                allow=settings.allow,
                writers=settings.writers,
                writer_idle_s=settings.writer_idle_ms / 1000,
                writer_role=None if settings.tls is None else settings.tls.writer_role,
            ),
            low_word_first=settings.low_word_first,
            tls=None if settings.tls is None else server_context(settings.tls),
        )
    return ClientWire(
        _client(settings),
        port=settings.port,
        bases=(settings.command_base, settings.status_base),
        command_function=settings.command_function,
        poll_s=settings.poll_ms / 1000,
        low_word_first=settings.low_word_first,
    )


def _client(settings: PlcSettings) -> Words:
    timeout_s = settings.timeout_ms / 1000
    if settings.s7 is not None:
        return S7Client(settings.host, settings.port, settings.s7, timeout_s=timeout_s)
    tls = None if settings.tls is None else client_context(settings.tls)
    return ModbusClient(settings.host, settings.port, unit=settings.unit, timeout_s=timeout_s, tls=tls)

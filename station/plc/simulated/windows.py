"""Access of the simulated PLC to the two windows: in the station over the network, or in its own memory."""

import asyncio
import struct
from collections.abc import Callable
from typing import Protocol

from station.errors import LineError
from station.plc.map.registers import STATUS_START, STATUS_WORDS
from station.plc.wire.modbus import ModbusClient, ModbusServer

STORM = 12
"""Number of connections that are opened and closed in a storm."""
BURST, BURST_S, ANSWER_BYTES = 60, 20.0, 11
"""Number of requests in a burst, time for their answers, and length of each answer."""


class Windows(Protocol):
    """Access of the PLC to the two windows."""

    async def connect(self) -> None:
        """Connect. Raises LineError."""

    async def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers from an address of the map. Raises LineError."""

    async def write(self, address: int, words: list[int]) -> None:
        """Write registers. Raises LineError."""

    async def storm(self) -> None:
        """Connect and disconnect many times. Raises LineError."""

    async def burst(self) -> None:
        """Send many requests at once, as a client without turns does. Raises LineError."""

    async def close(self) -> None:
        """Close the connection or stop the server."""


class RemoteWindows:
    """Windows in the memory of the station, which is the server."""

    def __init__(self, make: Callable[[], ModbusClient], address: tuple[str, int] | None = None) -> None:
        """`address`: where bursts are sent to; None: nowhere."""
        self._make, self._client, self._address = make, make(), address

    @staticmethod
    def at(host: str, port: int) -> "RemoteWindows":
        """Return the windows of the station at an address, over plain TCP."""
        return RemoteWindows(lambda: ModbusClient(host, port), (host, port))

    async def connect(self) -> None:
        """Connect. Raises LineError."""
        await self._client.connect()

    async def read(self, address: int, count: int) -> list[int]:
        """Return `count` registers. Raises LineError."""
        return await self._client.read(address, count)

    async def write(self, address: int, words: list[int]) -> None:
        """Write registers. Raises LineError."""
        await self._client.write(address, words)

    async def storm(self) -> None:
        """Open and close many connections, the own one included. Raises LineError."""
        for _ in range(STORM):
            other = self._make()
            await other.connect()
            other.close()
        self._client.close()
        self._client = self._make()
        await self._client.connect()

    async def burst(self) -> None:
        """Read one register in each of many requests, sent at once. Raises LineError if one has no answer."""
        if self._address is None:
            return
        asked = b"".join(struct.pack(">HHHBBHH", i, 0, 6, 1, 3, STATUS_START + i, 1) for i in range(BURST))
        try:
            async with asyncio.timeout(BURST_S):
                reader, writer = await asyncio.open_connection(*self._address)
                try:
                    writer.write(asked)
                    answers = await reader.readexactly(BURST * ANSWER_BYTES)
                finally:
                    writer.close()
                    await writer.wait_closed()
        except (OSError, EOFError, TimeoutError) as error:
            raise LineError(f"a burst of {BURST} requests was not answered: {error}") from None
        numbers = [int.from_bytes(answers[at : at + 2], "big") for at in range(0, len(answers), ANSWER_BYTES)]
        if numbers != list(range(BURST)):
            raise LineError(f"a burst of {BURST} requests was answered out of turn")

    async def close(self) -> None:
        """Close the connection."""
        self._client.close()


class OwnWindows:
    """Windows in the own memory; the PLC is the server into which the station writes."""

    def __init__(self, host: str, port: int) -> None:
        words = STATUS_START + STATUS_WORDS
        self._host, self._words = host, words
        self._server = self._at(port)

    def _at(self, port: int) -> ModbusServer:
        return ModbusServer(self._host, port, words=self._words, writable=range(STATUS_START, self._words))

    @property
    def port(self) -> int:
        """TCP port in use."""
        return self._server.port

    async def connect(self) -> None:
        """Listen. Raises LineError."""
        await self._server.start()

    async def read(self, address: int, count: int) -> list[int]:
        """Return registers of the own memory, which the station may be writing."""
        return await self._server.read(address, count)

    async def write(self, address: int, words: list[int]) -> None:
        """Write to the own memory."""
        await self._server.write(address, words)

    async def storm(self) -> None:
        """Stop the server and start it again; its memory keeps its contents."""
        contents = await self._server.read(0, self._words)
        await self._server.stop()
        self._server = self._at(self._server.port)
        await self._server.start()
        await self._server.write(0, contents)

    async def burst(self) -> None:
        """Do nothing: a PLC that is the server sends no requests."""

    async def close(self) -> None:
        """Stop the server."""
        await self._server.stop()

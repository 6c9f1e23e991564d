"""The two windows as the simulated PLC reaches them: over the network (the station is the server) or in its own memory."""

from collections.abc import Callable
from typing import Protocol

from station.plc.map.registers import STATUS_START, STATUS_WORDS
from station.plc.wire.modbus import ModbusClient, ModbusServer

STORM = 12
"""Connections that come and go in a storm."""


class Windows(Protocol):
    """How the PLC reaches the two windows."""

    async def connect(self) -> None:
        """Raises LineError."""

    async def read(self, address: int, count: int) -> list[int]:
        """Registers, addresses as in the map. Raises LineError."""

    async def write(self, address: int, words: list[int]) -> None:
        """Raises LineError."""

    async def storm(self) -> None:
        """Connect and vanish many times."""

    async def close(self) -> None:
        """End."""


class RemoteWindows:
    """The station is the server."""

    def __init__(self, make: Callable[[], ModbusClient]) -> None:
        self._make, self._client = make, make()

    async def connect(self) -> None:
        """Raises LineError."""
        await self._client.connect()

    async def read(self, address: int, count: int) -> list[int]:
        """Raises LineError."""
        return await self._client.read(address, count)

    async def write(self, address: int, words: list[int]) -> None:
        """Raises LineError."""
        await self._client.write(address, words)

    async def storm(self) -> None:
        """Connections that come and go, ours too."""
        for _ in range(STORM):
            other = self._make()
            await other.connect()
            other.close()
        self._client.close()
        self._client = self._make()
        await self._client.connect()

    async def close(self) -> None:
        """Drop the connection."""
        self._client.close()


class OwnWindows:
    """The PLC is the server; the station writes into its memory."""

    def __init__(self, host: str, port: int) -> None:
        words = STATUS_START + STATUS_WORDS
        self._host, self._words = host, words
        self._server = self._at(port)

    def _at(self, port: int) -> ModbusServer:
        return ModbusServer(self._host, port, words=self._words, writable=range(STATUS_START, self._words))

    @property
    def port(self) -> int:
        """Port in use."""
        return self._server.port

    async def connect(self) -> None:
        """Listen. Raises LineError."""
        await self._server.start()

    async def read(self, address: int, count: int) -> list[int]:
        """Our own memory, perhaps half-way through a copy."""
        return await self._server.read(address, count)

    async def write(self, address: int, words: list[int]) -> None:
        """Into our own memory."""
        await self._server.write(address, words)

    async def storm(self) -> None:
        """The PLC's server goes and comes back; its memory keeps what was there."""
        kept = await self._server.read(0, self._words)
        await self._server.stop()
        self._server = self._at(self._server.port)
        await self._server.start()
        await self._server.write(0, kept)

    async def close(self) -> None:
        """Stop the server."""
        await self._server.stop()

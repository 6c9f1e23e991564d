"""S7 client: words of a data block; the only file that imports snap7.

It reads and writes the memory of an S7-300, 400, 1200 or 1500 as its own programming tools do (PUT/GET), so
the PLC needs no server block. Nothing of it is encrypted or signed.
"""

import asyncio
import logging
import struct
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any, TypeVar

from station.errors import LineError, SettingsError
from station.settings.plc import S7Settings

if TYPE_CHECKING:
    from snap7.async_client import AsyncClient

Found = TypeVar("Found")
MOST_BYTES, MIN_PDU = 200, 240
"""Largest number of bytes in one request, and of a PDU for it: a split request can be read in half."""


class S7Client:
    """Words of a data block of a PLC; a request that is not answered in time closes the connection."""

    def __init__(self, host: str, port: int, settings: S7Settings, *, timeout_s: float) -> None:
        """`timeout_s`: time for the answer to one request. Raises SettingsError without the package."""
        try:
            from snap7.async_client import AsyncClient
        except ImportError:
            raise SettingsError("plc.s7 needs the package python-snap7: pip install 'weldgate[s7]'") from None
        logging.getLogger("snap7").setLevel(logging.CRITICAL)
        self._make, self._settings = AsyncClient, settings
        self._host, self._port, self._timeout_s = host, port, timeout_s
        self._address = f"{host}:{port}"
        self._client: AsyncClient | None = None

    async def connect(self) -> None:
        """Open a new connection. Raises LineError if no S7 answers."""
        self.close()
        client = self._client = self._make()
        settings = self._settings
        opening = client.connect(self._host, settings.rack, settings.slot, tcp_port=self._port)
        await self._asked("no S7 PLC; check address, rack and slot, and that PUT/GET is permitted", opening)
        if client.pdu_length < MIN_PDU:
            raise self._lost(f"its PDUs have {client.pdu_length} bytes, {MIN_PDU} are needed")

    async def read(self, address: int, count: int, function: int = 3) -> list[int]:
        """Return words of the data block from a word address, in one read; `function` is of Modbus alone.

        Raises LineError.
        """
        what = f"read of {count} words at {address} of DB{self._settings.db}"
        answer = await self._asked(
            what, self._open(what).db_read(self._settings.db, 2 * address, _whole(2 * count))
        )
        if len(answer) != 2 * count:
            raise self._lost(f"{what}: {len(answer)} bytes came")
        return list(struct.unpack(f">{count}H", answer))

    async def write(self, address: int, words: list[int]) -> None:
        """Write words at once. Raises LineError; then it is unknown whether the PLC has them."""
        what = f"write of {len(words)} words at {address} of DB{self._settings.db}"
        data = bytearray(struct.pack(f">{len(words)}H", *words))
        _whole(len(data))
        await self._asked(what, self._open(what).db_write(self._settings.db, 2 * address, data))

    def close(self) -> None:
        """Close the connection at once."""
        client, self._client = self._client, None
        connection = None if client is None else client.connection
        writer = None if connection is None else connection._writer  # noqa: SLF001  its own way waits
        if writer is not None:
            writer.transport.abort()

    def _open(self, what: str) -> "AsyncClient":
        if self._client is None:
            raise self._lost(f"{what}: the connection is closed")
        return self._client

    async def _asked(self, what: str, request: Coroutine[Any, Any, Found]) -> Found:
        """Return the answer to a request. Raises LineError for whatever goes wrong on the wire."""
        try:
            async with asyncio.timeout(self._timeout_s):
                return await request
        except TimeoutError:
            raise self._lost(f"{what}: no answer") from None
        except Exception as error:  # noqa: BLE001  its parser raises what the bytes make it raise
            raise self._lost(f"{what}: {error}") from None

    def _lost(self, why: str) -> LineError:
        self.close()
        return LineError(f"{self._address}: {why}")


def _whole(size: int) -> int:
    """Return a number of bytes that fits into one request. Raises ValueError for more."""
    if size > MOST_BYTES:
        raise ValueError(f"{size} bytes do not fit into one request of {MOST_BYTES}")
    return size

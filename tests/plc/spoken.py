"""PLCs that are servers, one for each protocol of client mode: their memory, and settings to reach it."""

import asyncio
import struct
from contextlib import suppress
from typing import Any, Protocol

from snap7.server import Server
from snap7.type import SrvArea

from station.errors import LineError
from station.plc.map.registers import COMMAND_START, COMMAND_WORDS, STATUS_START, STATUS_WORDS, reordered
from station.plc.simulated.windows import OwnWindows, Windows
from station.plc.wire.modbus import ModbusServer
from station.settings.model import PlcSettings
from station.settings.plc import S7Settings

WORDS = STATUS_START + STATUS_WORDS
DB = 10


class Peer(Protocol):
    """What the tests of client mode need of a protocol."""

    mute: str
    """What is said of a PLC that takes connections and answers nothing."""
    refused: str
    """What is said of a status window at word 4000."""
    status_seen: list[int]
    """STATUS as the PLC read it after each write."""

    def windows(self, port: int, low_word_first: bool = False) -> Windows: ...
    def settings(self, port: int, **changes: Any) -> PlcSettings: ...
    def writes(self, request: bytes) -> bool: ...


class Reordered:
    """Windows of a PLC that keeps 32-bit values with the low word first."""

    def __init__(self, windows: Windows) -> None:
        self._windows = windows

    async def read(self, address: int, count: int) -> list[int]:
        words = await self._windows.read(address, count)
        return reordered(STATUS_START, words) if count == STATUS_WORDS else words

    async def write(self, address: int, words: list[int]) -> None:
        await self._windows.write(
            address, reordered(COMMAND_START, words) if len(words) == COMMAND_WORDS else words
        )

    def __getattr__(self, name: str) -> Any:
        return getattr(self._windows, name)


class _Watched(OwnWindows):
    def __init__(self, port: int, seen: list[int]) -> None:
        self.seen = seen
        super().__init__("127.0.0.1", port)

    def _at(self, port: int) -> ModbusServer:
        writable = range(STATUS_START, self._words)
        return ModbusServer(self._host, port, words=self._words, writable=writable, on_write=self._written)

    def _written(self) -> None:
        async def look() -> None:
            with suppress(LineError):  # it has just ended
                self.seen.extend(await self._server.read(STATUS_START, 1))

        self.looks = asyncio.ensure_future(look())


class ModbusPeer:
    mute, refused = "No response", "4000 refused"

    def __init__(self) -> None:
        self.status_seen: list[int] = []

    def windows(self, port: int, low_word_first: bool = False) -> Windows:
        windows = _Watched(port, self.status_seen)
        return Reordered(windows) if low_word_first else windows

    def settings(self, port: int, **changes: Any) -> PlcSettings:
        return PlcSettings(mode="client", port=port, **changes)

    def writes(self, request: bytes) -> bool:
        return request[7] == 16


class _S7Plc(Server):
    """The memory of an S7 with one data block, which notes STATUS after each write."""

    def __init__(self, memory: bytearray, seen: list[int]) -> None:
        super().__init__(log=False)
        self.memory, self.seen = memory, seen
        self.register_area(SrvArea.DB, DB, memory)

    def _write_to_memory_area(self, *where: Any) -> bool:
        done = super()._write_to_memory_area(*where)
        self.seen.append(struct.unpack_from(">H", self.memory, 2 * STATUS_START)[0])
        return done


class S7Windows:
    """The data block, as the program of the PLC has it."""

    def __init__(self, port: int, seen: list[int]) -> None:
        self._port, self._seen, self._memory = port, seen, bytearray(2 * WORDS)
        self._server = _S7Plc(self._memory, seen)

    async def connect(self) -> None:
        self._server.start_to("127.0.0.1", self._port)

    async def read(self, address: int, count: int) -> list[int]:
        return list(struct.unpack(f">{count}H", bytes(self._memory[2 * address : 2 * (address + count)])))

    async def write(self, address: int, words: list[int]) -> None:
        self._memory[2 * address : 2 * (address + len(words))] = struct.pack(f">{len(words)}H", *words)

    async def storm(self) -> None:
        await self.close()
        self._server = _S7Plc(self._memory, self._seen)
        await self.connect()

    async def burst(self) -> None:
        pass

    async def close(self) -> None:
        await asyncio.to_thread(self._server.stop)


class S7Peer:
    mute, refused = "no S7 PLC", f"at 4000 of DB{DB}"

    def __init__(self) -> None:
        self.status_seen: list[int] = []

    def windows(self, port: int, low_word_first: bool = False) -> Windows:
        windows = S7Windows(port, self.status_seen)
        return Reordered(windows) if low_word_first else windows

    def settings(self, port: int, **changes: Any) -> PlcSettings:
        return PlcSettings(mode="client", port=port, s7=S7Settings(db=DB), **changes)

    def writes(self, request: bytes) -> bool:
        """TPKT and COTP are 7 bytes, the header of a job 10; then comes the function."""
        return len(request) > 17 and request[7:9] == b"\x32\x01" and request[17] == 5

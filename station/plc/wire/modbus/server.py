"""Modbus TCP server: registers that peers read and write.

The server's memory is touched only from its own loop, and a window is written in one call: no reader sees
half of a window.
"""

import asyncio
from collections.abc import Callable

from pymodbus.constants import ExcCodes
from pymodbus.exceptions import ModbusException
from pymodbus.pdu.device import ModbusDeviceIdentification
from pymodbus.server import ModbusTcpServer
from pymodbus.simulator import DataType, SimData, SimDevice

from station import __version__
from station.errors import LineError
from station.plc.wire.access import EVERYBODY, Access
from station.plc.wire.admission import PATIENCE_S, TLS_PATIENCE_S
from station.plc.wire.modbus.listener import Listener
from station.plc.wire.modbus.peer import ModbusPeer, asking
from station.plc.wire.peers import Peers
from station.plc.wire.requests import CLIENT_WRITES, writes_within
from station.plc.wire.tls import Tls

READ, WRITE = 3, 4
"""Function codes of the station's own access to the server's memory; 4 can never be a client's write."""


class ModbusServer:
    """Registers that peers read and write; lives in the loop that starts it and answers every unit id."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        words: int,
        writable: range,
        on_write: Callable[[], None] = lambda: None,
        access: Access = EVERYBODY,
        tls: Tls = None,
    ) -> None:
        """`words`: number of registers; `writable`: what peers may write; `on_write`: called after it."""
        self.host, self.port = host, port
        self._words, self._writable, self._on_write, self._tls = words, writable, on_write, tls
        self._peers = Peers(access, PATIENCE_S if tls is None else TLS_PATIENCE_S)
        self._server: ModbusTcpServer | None = None
        self._listener: Listener | None = None

    async def start(self) -> None:
        """Listen. Raises LineError if the port cannot be used."""
        info = {"VendorName": "weldgate", "ProductCode": "WG", "ProductName": "weldgate"}
        info["MajorMinorRevision"] = __version__
        identity = ModbusDeviceIdentification(info_name=info)  # type: ignore[no-untyped-call]
        words = [SimData(0, count=self._words, datatype=DataType.REGISTERS)]
        device = SimDevice(id=0, simdata=words, use_bit_addressing=True, identity=identity, action=self._gate)
        address = (self.host, self.port)
        try:
            server = ModbusTcpServer(device, identity=identity, address=address)
            server.callback_new_connection = lambda: self._new_peer(server)  # type: ignore[method-assign]
            listener = Listener(self._peers, server.handle_new_connection)
            server.call_create = lambda: listener.open(self.host, self.port)
            await server.serve_forever(background=True)
        except (OSError, RuntimeError, ModbusException) as error:
            where = f"{self.host}:{self.port}"
            message = f"Modbus server cannot listen on {where} ({error}); free the port or set plc.port"
            raise LineError(message) from None
        self._server, self._listener = server, listener
        self.port = listener.port

    async def stop(self) -> None:
        """Set all registers to 0 and close all connections."""
        if self._server is not None:
            await self.write(0, [0] * self._words)
            self._peers.drop_all()
            await self._server.shutdown()  # type: ignore[no-untyped-call]
            self._server = None
        if self._listener is not None:
            await self._listener.wait_closed()
            self._listener = None

    async def read(self, address: int, count: int) -> list[int]:
        """Return the present words of `count` registers."""
        return [int(word) for word in await self._running().async_getValues(1, READ, address, count)]

    async def write(self, address: int, words: list[int]) -> None:
        """Write all words at once."""
        await self._running().async_setValues(1, WRITE, address, words)

    def _running(self) -> ModbusTcpServer:
        if self._server is None:
            raise LineError("the Modbus server is not running")
        return self._server

    def _new_peer(self, server: ModbusTcpServer) -> ModbusPeer:
        return ModbusPeer(self._peers, server, self._words, self._tls)

    async def _gate(
        self,
        function: int,
        _start: int,
        address: int,
        count: int,
        _current: list[int],
        values: list[int] | list[bool] | None,
    ) -> ExcCodes | None:
        """Refuse a write: exception 02 outside the window, 06 while another peer has the right, else 01."""
        if function not in CLIENT_WRITES or values is None:
            return None
        if not writes_within(self._writable, function, address, count):
            what = f"function {function}, address {address}, {count} registers"
            self._peers.refused_write(asking.get(0), what)
            return ExcCodes.ILLEGAL_ADDRESS
        code = self._peers.write_refusal(asking.get(0))
        if code is not None:
            return ExcCodes(code)
        asyncio.get_running_loop().call_soon(self._on_write)
        return None

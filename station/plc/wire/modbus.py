"""Modbus TCP server and client; the only file that imports pymodbus.

The server's memory is touched only from its own loop, and a window is written in one call: no reader sees
half of a window.
"""

import asyncio
import contextvars
import itertools
import logging
import time
from collections.abc import Callable, Sequence
from contextlib import suppress

from pymodbus.client import AsyncModbusTcpClient
from pymodbus.constants import ExcCodes
from pymodbus.exceptions import ModbusException
from pymodbus.framer import FramerType
from pymodbus.pdu import ModbusPDU
from pymodbus.pdu.device import ModbusDeviceIdentification
from pymodbus.server import ModbusTcpServer, ModbusTlsServer
from pymodbus.server.requesthandler import ServerRequestHandler
from pymodbus.simulator import DataType, SimData, SimDevice
from pymodbus.transaction import TransactionManager
from pymodbus.transport import CommParams, CommType

from station import __version__
from station.errors import LineError
from station.plc.wire.access import Network
from station.plc.wire.framing import CLIENT_WRITES, FUNCTIONS, frames, refusal, writes_within
from station.plc.wire.peers import HANDSHAKE_S, MAX_WAITING, Peers
from station.plc.wire.tls import Tls

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)

READ, WRITE = 3, 4
"""Function codes of the station's own access to the server's memory; 4 can never be a client's write."""
MAX_BYTES = 16384
"""Number of bytes that may arrive at once; pymodbus would silently drop all beyond 264."""

_peer: contextvars.ContextVar[int] = contextvars.ContextVar("peer")


class _Peer(ServerRequestHandler):
    """One connection: answers its requests in turn; bytes that are not Modbus end it."""

    numbers = itertools.count(1)

    def __init__(self, peers: Peers, server: ModbusTcpServer) -> None:
        super().__init__(server, None, None, None)  # type: ignore[no-untyped-call]
        self._peers = peers
        self._requests: asyncio.Queue[ModbusPDU | bytes] = asyncio.Queue(MAX_WAITING)
        self.max_buffer_size = MAX_BYTES
        self._answering: asyncio.Task[None] | None = None
        self.number, self.begun_s = next(self.numbers), time.monotonic()
        self.name = "unknown"
        self.heard_s = 0.0

    def callback_connected(self) -> None:
        super().callback_connected()
        self.name = str((self.transport.get_extra_info("peername") or ("unknown",))[0])
        if self._peers.admit(self):
            self._answering = asyncio.create_task(self._answer())
        else:
            _drop(self)

    def callback_disconnected(self, exc: Exception | None) -> None:
        super().callback_disconnected(exc)
        self.finish()

    def finish(self) -> None:
        """Answer no more requests."""
        if self._answering is not None:
            self._answering.cancel()
            self._answering = None
        self._peers.remove(self.number)

    def end(self, why: str) -> None:
        """Close the connection and log why."""
        self._peers.complain(self.name, why)
        self.drop()

    def drop(self) -> None:
        """Close the connection at once."""
        self.finish()
        _drop(self)

    def callback_data(self, data: bytes, addr: tuple | None = None) -> int:  # type: ignore[type-arg]
        if self._answering is None:
            return len(data)
        found, used, problem = frames(data)
        try:
            for frame in found:
                self._requests.put_nowait(self._read(frame))
                self.heard_s = time.monotonic()
        except asyncio.QueueFull:
            problem = f"sent more than {MAX_WAITING} requests without waiting for answers"
        if problem is not None:
            self.end(problem)
        return used

    def _read(self, frame: bytes) -> ModbusPDU | bytes:
        """Return the decoded request, or the refusal to send for it.

        pymodbus knows more functions than a register map needs, and fails on some of them.
        """
        self.last_pdu = None
        if frame[7] in FUNCTIONS:
            with suppress(Exception):  # struct errors, index errors, its own
                TransactionManager.callback_data(self, frame, None)
        return refusal(frame) if self.last_pdu is None else self.last_pdu

    async def _answer(self) -> None:
        _peer.set(self.number)
        while True:
            request = await self._requests.get()
            if isinstance(request, bytes):
                self.send(request)
                continue
            self.last_pdu, self.last_addr = request, None
            await self.handle_request()  # type: ignore[no-untyped-call]


def _drop(connection: TransactionManager) -> None:
    """Close a connection at once, without waiting for a TLS peer that may have disappeared."""
    transport = connection.transport
    connection.close()
    if isinstance(transport, asyncio.WriteTransport):
        transport.abort()


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
        allow: Sequence[Network] = (),
        writer_idle_s: float = float("inf"),
        tls: Tls = None,
    ) -> None:
        """`words`: number of registers; `writable`: what peers may write; `on_write`: called after it."""
        self.host, self.port = host, port
        self._words, self._writable, self._on_write, self._tls = words, writable, on_write, tls
        self._peers = Peers(allow=allow, writer_idle_s=writer_idle_s)
        self._server: ModbusTcpServer | None = None

    async def start(self) -> None:
        """Listen. Raises LineError if the port cannot be used."""
        info = {"VendorName": "weldgate", "ProductCode": "WG", "ProductName": "weldgate"}
        info["MajorMinorRevision"] = __version__
        identity = ModbusDeviceIdentification(info_name=info)  # type: ignore[no-untyped-call]
        words = [SimData(0, count=self._words, datatype=DataType.REGISTERS)]
        device = SimDevice(id=0, simdata=words, use_bit_addressing=True, identity=identity, action=self._gate)
        address = (self.host, self.port)
        try:
            if self._tls is None:
                server = ModbusTcpServer(device, identity=identity, address=address)
            else:  # Modbus/TCP Security keeps the MBAP header, which pymodbus' own TLS framing lacks
                server = ModbusTlsServer(
                    device, identity=identity, address=address, sslctx=self._tls, framer=FramerType.SOCKET
                )
            server.callback_new_connection = lambda: self._new_peer(server)  # type: ignore[method-assign]
            await server.serve_forever(background=True)
        except (OSError, RuntimeError, ModbusException) as error:
            where = f"{self.host}:{self.port}"
            message = f"Modbus server cannot listen on {where} ({error}); free the port or set plc.port"
            raise LineError(message) from None
        self._server = server
        if sockets := getattr(server.transport, "sockets", ()):
            self.port = sockets[0].getsockname()[1]

    async def stop(self) -> None:
        """Set all registers to 0 and close all connections."""
        if self._server is not None:
            await self.write(0, [0] * self._words)
            self._peers.drop_all()
            await self._server.shutdown()  # type: ignore[no-untyped-call]
            self._server = None

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

    def _new_peer(self, server: ModbusTcpServer) -> _Peer:
        """Return the peer of a new connection; forget those never set up, which pymodbus would keep."""
        oldest_s = time.monotonic() - HANDSHAKE_S
        for key, peer in list(server.active_connections.items()):
            if getattr(peer, "transport", None) is None and getattr(peer, "begun_s", 0.0) < oldest_s:
                del server.active_connections[key]
        return _Peer(self._peers, server)

    async def _gate(
        self,
        function: int,
        _start: int,
        address: int,
        count: int,
        _current: list[int],
        values: list[int] | list[bool] | None,
    ) -> ExcCodes | None:
        """Refuse a write: exception 02 outside the window, 06 while another peer has the right to write."""
        if function not in CLIENT_WRITES or values is None:
            return None
        if not writes_within(self._writable, function, address, count):
            return ExcCodes.ILLEGAL_ADDRESS
        if not self._peers.may_write(_peer.get(0)):
            return ExcCodes.DEVICE_BUSY
        asyncio.get_running_loop().call_soon(self._on_write)
        return None


class _Client(AsyncModbusTcpClient):
    """pymodbus' client, plain or over TLS; unlike its own TLS client, it sends the MBAP header."""

    def __init__(self, host: str, port: int, timeout_s: float, tls: Tls) -> None:
        self.comm_params = CommParams(
            comm_type=CommType.TCP if tls is None else CommType.TLS,
            host=host,
            port=port,
            sslctx=tls,
            comm_name="client",
            reconnect_delay=0.0,
            reconnect_delay_max=0.0,
            timeout_connect=timeout_s,
        )
        super().__init__("", retries=0)


class ModbusClient:
    """Registers of another machine; a request that is not answered in time closes the connection."""

    def __init__(
        self, host: str, port: int, *, unit: int = 1, timeout_s: float = 1.0, tls: Tls = None
    ) -> None:
        self._host, self._port, self._unit, self._timeout_s, self._tls = host, port, unit, timeout_s, tls
        self._address = f"{host}:{port}"
        self._client: AsyncModbusTcpClient | None = None

    async def connect(self) -> None:
        """Open a new connection. Raises LineError if nothing answers."""
        self.close()
        client = _Client(self._host, self._port, self._timeout_s, self._tls)
        connected = False
        with suppress(OSError, ModbusException):
            connected = await client.connect()
        if not connected:
            _drop(client.ctx)
            raise LineError(f"no Modbus server at {self._address}; check that it runs, and the firewall")
        self._client = client

    async def read(self, address: int, count: int) -> list[int]:
        """Return up to 125 words in one read. Raises LineError."""
        try:
            response = await self._open().read_holding_registers(address, count=count, device_id=self._unit)
        except ModbusException as error:
            raise self._lost(f"read: {error}") from None
        if response.isError() or len(response.registers) != count:
            raise self._lost(f"read of {count} registers at {address} refused: {response}")
        return list(response.registers)

    async def write(self, address: int, words: list[int]) -> None:
        """Write up to 123 words at once. Raises LineError; then it is unknown whether the peer has them."""
        try:
            response = await self._open().write_registers(address, words, device_id=self._unit)
        except ModbusException as error:
            raise self._lost(f"write: {error}") from None
        if response.isError():
            raise self._lost(f"write of {len(words)} registers at {address} refused: {response}")

    def _open(self) -> AsyncModbusTcpClient:
        if self._client is None or not self._client.connected:
            raise self._lost("the connection is closed")
        return self._client

    def _lost(self, why: str) -> LineError:
        self.close()
        return LineError(f"{self._address}: {why}")

    def close(self) -> None:
        """Close the connection."""
        if self._client is not None:
            _drop(self._client.ctx)
            self._client = None

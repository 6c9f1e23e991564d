"""Modbus TCP, a server and a client; the only file that imports pymodbus.

The server's memory is touched from its own loop alone, and a window is written in one call: no reader sees half of one.
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
from station.plc.wire.access import Complaints, Network, WriteRight, admitted
from station.plc.wire.framing import CLIENT_WRITES, FUNCTIONS, frames, refusal
from station.plc.wire.tls import Tls

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)

READ, WRITE = 3, 4
"""Function codes of our own access; 4 can never be a client's write."""
MAX_PEERS, HANDSHAKE_S = 128, 60.0
MAX_WAITING = 16
"""Requests of one peer that wait for their answer."""
MAX_BYTES = 16384
"""Of requests that came at once; pymodbus would drop all beyond 264 without a word."""

_peer: contextvars.ContextVar[int] = contextvars.ContextVar("peer")


class _Peer(ServerRequestHandler):
    """One connection. Its requests are answered one by one, also those that came in one packet; noise ends it."""

    numbers = itertools.count(1)

    def __init__(self, owner: "ModbusServer", server: ModbusTcpServer) -> None:
        super().__init__(server, None, None, None)  # type: ignore[no-untyped-call]
        self._owner = owner
        self._requests: asyncio.Queue[ModbusPDU | bytes] = asyncio.Queue(MAX_WAITING)
        self.max_buffer_size = MAX_BYTES
        self._answering: asyncio.Task[None] | None = None
        self.number, self.begun_s = next(self.numbers), time.monotonic()
        self.name = "unknown"
        self.heard_s = 0.0
        """Time of the last request; 0: none yet."""

    def callback_connected(self) -> None:
        super().callback_connected()
        self.name = str((self.transport.get_extra_info("peername") or ("unknown",))[0])
        if self._owner.welcome(self):
            self._answering = asyncio.create_task(self._answer())
        else:
            _drop(self)

    def callback_disconnected(self, exc: Exception | None) -> None:
        super().callback_disconnected(exc)
        self.over()

    def over(self) -> None:
        """Nothing more is answered."""
        if self._answering is not None:
            self._answering.cancel()
            self._answering = None
        self._owner.goodbye(self)

    def end(self, why: str) -> None:
        """Close the connection and say why."""
        self._owner.complaints.closed(self.name, why)
        self.over()
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
        """The request, or its refusal. pymodbus knows more functions than a register map needs, and stumbles over some of them."""
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
    """Close at once: a TLS peer that is gone would be waited for."""
    transport = connection.transport
    connection.close()
    if isinstance(transport, asyncio.WriteTransport):
        transport.abort()


class ModbusServer:
    """Registers that peers read and write; lives in the loop that starts it. Unit ids do not matter."""

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
        self.host, self.port = host, port
        self._words, self._writable, self._on_write = words, writable, on_write
        self._allow, self._right, self._tls = allow, WriteRight(writer_idle_s), tls
        self._server: ModbusTcpServer | None = None
        self._peers: dict[int, _Peer] = {}
        self.complaints = Complaints()

    async def start(self) -> None:
        """Listen. Raises LineError if the port cannot be had."""
        info = {"VendorName": "weldgate", "ProductCode": "WG", "ProductName": "weldgate", "MajorMinorRevision": __version__}
        identity = ModbusDeviceIdentification(info_name=info)  # type: ignore[no-untyped-call]
        memory = [SimData(0, count=self._words, datatype=DataType.REGISTERS)]
        device = SimDevice(id=0, simdata=memory, use_bit_addressing=True, identity=identity, action=self._gate)
        address = (self.host, self.port)
        try:
            if self._tls is None:
                server = ModbusTcpServer(device, identity=identity, address=address)
            else:  # Modbus/TCP Security keeps the MBAP header, which pymodbus' own TLS framing lacks
                server = ModbusTlsServer(device, identity=identity, address=address, sslctx=self._tls, framer=FramerType.SOCKET)
            server.callback_new_connection = lambda: self._expected(server)  # type: ignore[method-assign]
            await server.serve_forever(background=True)
        except (OSError, RuntimeError, ModbusException) as error:
            raise LineError(f"Modbus server cannot listen on {self.host}:{self.port} ({error}); free the port or set plc.port") from None
        self._server = server
        if sockets := getattr(server.transport, "sockets", ()):
            self.port = sockets[0].getsockname()[1]

    async def stop(self) -> None:
        """Zero all, close all connections."""
        if self._server is not None:
            await self.write(0, [0] * self._words)
            for peer in list(self._peers.values()):
                peer.over()
                _drop(peer)
            await self._server.shutdown()  # type: ignore[no-untyped-call]
            self._server = None

    async def read(self, address: int, count: int) -> list[int]:
        """Words as they are now."""
        return [int(w) for w in await self._running().async_getValues(1, READ, address, count)]

    async def write(self, address: int, words: list[int]) -> None:
        """All words at once."""
        await self._running().async_setValues(1, WRITE, address, words)

    def _running(self) -> ModbusTcpServer:
        if self._server is None:
            raise LineError("the Modbus server is not running")
        return self._server

    def _expected(self, server: ModbusTcpServer) -> _Peer:
        """A peer that begins to connect; those that never finish, as after a failed TLS handshake, pymodbus would keep for ever."""
        for key, peer in list(server.active_connections.items()):
            if getattr(peer, "transport", None) is None and time.monotonic() - getattr(peer, "begun_s", 0.0) > HANDSHAKE_S:
                del server.active_connections[key]
        return _Peer(self, server)

    def welcome(self, peer: _Peer) -> bool:
        """Whether a new connection may stay; the one that was silent longest makes room."""
        if not admitted(peer.name, self._allow):
            self.complaints.closed(peer.name, "is not on the list plc.allow")
            return False
        if len(self._peers) >= MAX_PEERS:
            min(self._peers.values(), key=lambda p: p.heard_s).end(f"was silent longest of {MAX_PEERS} connections")
        self._peers[peer.number] = peer
        return True

    def goodbye(self, peer: _Peer) -> None:
        """It is gone."""
        self._peers.pop(peer.number, None)
        self._right.drop(peer.number)

    async def _gate(
        self, function: int, _start: int, address: int, count: int, _current: list[int], values: list[int] | list[bool] | None
    ) -> ExcCodes | None:
        """Refuse what a peer must not write: exception 02 outside its window, 06 while another peer has the right to write."""
        if function not in CLIENT_WRITES or values is None:
            return None
        first = address // 16 if function in (5, 15) else address
        last = first + count - 1  # pymodbus counts registers here, for bits too
        if not (first in self._writable and last in self._writable):
            return ExcCodes.ILLEGAL_ADDRESS
        if not self._right.take(_peer.get(0), time.monotonic()):
            return ExcCodes.DEVICE_BUSY
        asyncio.get_running_loop().call_soon(self._on_write)
        return None


class _Client(AsyncModbusTcpClient):
    """pymodbus' client, plain or over TLS; its own TLS client leaves out the MBAP header, as its TLS server does."""

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
    """Registers of another machine. A request without an answer in time closes the connection: its effect is unknown."""

    def __init__(self, host: str, port: int, *, unit: int = 1, timeout_s: float = 1.0, tls: Tls = None) -> None:
        self._host, self._port, self._unit, self._timeout_s, self._tls = host, port, unit, timeout_s, tls
        self._address = f"{host}:{port}"
        self._client: AsyncModbusTcpClient | None = None

    async def connect(self) -> None:
        """A new connection. Raises LineError if nobody answers."""
        self.close()
        client = _Client(self._host, self._port, self._timeout_s, self._tls)
        connected = False
        with suppress(OSError, ModbusException):
            connected = await client.connect()
        if not connected:
            _drop(client.ctx)
            raise LineError(f"no Modbus server at {self._address}; is it running, and does a firewall let you through?")
        self._client = client

    async def read(self, address: int, count: int) -> list[int]:
        """Up to 125 words in one read. Raises LineError."""
        try:
            answer = await self._connected().read_holding_registers(address, count=count, device_id=self._unit)
        except ModbusException as error:
            raise self._lost(f"read: {error}") from None
        if answer.isError() or len(answer.registers) != count:
            raise self._lost(f"read of {count} registers at {address} refused: {answer}")
        return list(answer.registers)

    async def write(self, address: int, words: list[int]) -> None:
        """Up to 123 words in one write. Raises LineError; then it is unknown whether the peer has them."""
        try:
            answer = await self._connected().write_registers(address, words, device_id=self._unit)
        except ModbusException as error:
            raise self._lost(f"write: {error}") from None
        if answer.isError():
            raise self._lost(f"write of {len(words)} registers at {address} refused: {answer}")

    def _connected(self) -> AsyncModbusTcpClient:
        if self._client is None or not self._client.connected:
            raise self._lost("the connection is gone")
        return self._client

    def _lost(self, why: str) -> LineError:
        self.close()
        return LineError(f"{self._address}: {why}")

    def close(self) -> None:
        """Drop the connection."""
        if self._client is not None:
            _drop(self._client.ctx)
            self._client = None

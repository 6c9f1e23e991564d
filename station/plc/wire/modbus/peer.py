"""One connection to the Modbus server: TLS, requests in turn, answers."""

import asyncio
import contextvars
import itertools
import ssl
from contextlib import suppress

from pymodbus.pdu import ModbusPDU
from pymodbus.server import ModbusTcpServer
from pymodbus.server.requesthandler import ServerRequestHandler
from pymodbus.transaction import TransactionManager

from station.errors import LineError
from station.plc.wire.framing import refusal
from station.plc.wire.inbox import Inbox
from station.plc.wire.modbus.closing import close_at_once
from station.plc.wire.peers import HANDSHAKE_S, UNREAD_S, Peers
from station.plc.wire.requests import ILLEGAL_VALUE, exception
from station.plc.wire.tls import Tls, client_role

asking: contextvars.ContextVar[int] = contextvars.ContextVar("asking")
"""Number of the connection whose request is being answered."""


class ModbusPeer(ServerRequestHandler):
    """One connection: answers its requests in turn; bytes that are not Modbus end it."""

    numbers = itertools.count(1)

    def __init__(self, peers: Peers, server: ModbusTcpServer, registers: int, tls: Tls) -> None:
        super().__init__(server, None, None, None)  # type: ignore[no-untyped-call]
        self._peers, self._registers, self._tls = peers, registers, tls
        self._inbox = Inbox()
        self._task: asyncio.Task[None] | None = None
        self._written = asyncio.Event()
        self._written.set()
        self.number = next(self.numbers)
        self.name, self.since_s = "unknown", 0.0
        self.role: str | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Take in a connection: first comes TLS, then Modbus."""
        self.name = str((transport.get_extra_info("peername") or ("unknown",))[0])
        if not isinstance(transport, asyncio.Transport):
            super().connection_made(transport)
            close_at_once(self)
            return
        self._peers.admit(self)
        if self._tls is None:
            self._open(transport)
        else:
            transport.pause_reading()
            self.transport = transport
            self._task = asyncio.create_task(self._secure(transport, self._tls))

    async def _secure(self, transport: asyncio.Transport, tls: ssl.SSLContext) -> None:
        loop = asyncio.get_running_loop()
        try:
            async with asyncio.timeout(HANDSHAKE_S):
                secured = await loop.start_tls(transport, self, tls, server_side=True)
            checked = None if secured is None else client_role(secured, tls)
        except (OSError, TimeoutError, LineError) as error:
            self.end(f"could not set up TLS: {str(error) or 'no answer'}")
            return
        if secured is None:
            self.drop()
            return
        self.role = checked
        self._open(secured)

    def _open(self, transport: asyncio.Transport) -> None:
        super().connection_made(transport)
        self._inbox.attach(transport)
        self._task = asyncio.create_task(self._answer())

    def callback_disconnected(self, exc: Exception | None) -> None:
        """Forget a connection that is lost."""
        super().callback_disconnected(exc)
        self.finish()

    def finish(self) -> None:
        """Answer no more requests."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
        self._peers.remove(self.number)

    def end(self, why: str) -> None:
        """Close the connection and log why."""
        self._peers.complain(self.name, f"{why}; connection closed")
        self.drop()

    def drop(self) -> None:
        """Close the connection at once."""
        self.finish()
        close_at_once(self)

    def data_received(self, data: bytes) -> None:
        """Take in bytes; pymodbus' own buffer is cleared by each answer, with what has arrived meanwhile."""
        if self._inbox.feed(data):
            self._peers.heard(self)

    def pause_writing(self) -> None:
        """Wait with further answers: the peer does not read those it has."""
        self._written.clear()

    def resume_writing(self) -> None:
        """Go on answering."""
        self._written.set()

    async def _answer(self) -> None:
        asking.set(self.number)
        while (frame := await self._inbox.next()) is not None:
            try:
                async with asyncio.timeout(UNREAD_S):
                    await self._written.wait()
            except TimeoutError:
                self.end("does not read its answers")
                return
            await self._carry_out(frame)
            await asyncio.sleep(0)  # a peer with many requests does not hold up the others
        self.end(self._inbox.problem or "sent no request")

    async def _carry_out(self, frame: bytes) -> None:
        """Answer one request; its values are checked first, as pymodbus accepts or misreads some."""
        code = exception(frame[7:], self._registers)
        request = None if code is not None else self._decoded(frame)
        if request is not None:
            self.last_pdu, self.last_addr = request, None
            await self.handle_request()  # type: ignore[no-untyped-call]
        else:
            code = code or ILLEGAL_VALUE
            self._peers.refused(self.name, code, f"request {frame[6:18].hex(' ')}")
            self.send(refusal(frame, code))

    def _decoded(self, frame: bytes) -> ModbusPDU | None:
        self.last_pdu = None
        with suppress(Exception):  # struct errors, index errors, its own
            TransactionManager.callback_data(self, frame, None)
        return self.last_pdu

"""Accepts connections to the Modbus server, one at a time and only while there is room.

asyncio's own server accepts up to 100 connections before it reads from the first of them; here the others
wait, in their order, in the queue of the operating system.
"""

import asyncio
import socket
from collections.abc import Callable
from contextlib import suppress

from station.plc.wire.peers import Peers

QUEUE = 128
"""Number of connections that the operating system keeps waiting."""
PAUSE_S = 0.1
"""Time until the next attempt where the system gives no connection, as without a free descriptor."""


class Listener(asyncio.BaseTransport):
    """Listening sockets, and a task for each."""

    def __init__(self, peers: Peers, make: Callable[[], asyncio.BaseProtocol]) -> None:
        """`make`: returns the protocol of a new connection."""
        super().__init__()
        self._peers, self._make = peers, make
        self._sockets: list[socket.socket] = []
        self._tasks: list[asyncio.Task[None]] = []

    @property
    def port(self) -> int:
        """TCP port in use."""
        return int(self._sockets[0].getsockname()[1])

    async def open(self, host: str, port: int) -> "Listener":
        """Listen at all addresses of a host. Raises OSError."""
        found = await asyncio.get_running_loop().getaddrinfo(
            host or None, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )
        try:
            for family, address in dict.fromkeys((family, address) for family, _, _, _, address in found):
                self._sockets.append(socket.create_server(address, family=family, backlog=QUEUE))
        except OSError:
            for listening in self._sockets:
                listening.close()
            raise
        for listening in self._sockets:
            listening.setblocking(False)
            self._tasks.append(asyncio.create_task(self._accept(listening)))
        return self

    def close(self) -> None:
        """Accept no more connections."""
        for task in self._tasks:
            task.cancel()

    async def wait_closed(self) -> None:
        """Free the port; a task that was cancelled before it began would never close its socket."""
        await asyncio.gather(*self._tasks, return_exceptions=True)
        for listening in self._sockets:
            listening.close()

    async def _accept(self, listening: socket.socket) -> None:
        while True:
            try:
                connection, address = await asyncio.get_running_loop().sock_accept(listening)
            except OSError:
                await asyncio.sleep(PAUSE_S)
                continue
            await self._take_in(connection, str(address[0]))

    async def _take_in(self, connection: socket.socket, name: str) -> None:
        taken = False
        try:
            if self._peers.may_connect(name):
                await self._peers.room(name)
                with suppress(OSError):  # it is gone again
                    await asyncio.get_running_loop().connect_accepted_socket(self._make, connection)
                    taken = True
        finally:
            if not taken:
                connection.close()

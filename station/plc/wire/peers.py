"""The peers of the Modbus server: which may connect, which make room for others, and which one may write."""

import asyncio
import time
from contextlib import suppress
from typing import Protocol

from station.plc.wire.access import Access, Complaints, WriteRight, admitted
from station.plc.wire.admission import (
    MAX_CLIENTS,
    MAX_NEWCOMERS,
    PATIENCE_S,
    Place,
    client_to_close,
    newcomer_to_close,
)
from station.plc.wire.requests import BUSY, ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, MEANINGS

HANDSHAKE_S = 10.0
"""Time within which the TLS handshake of a new connection must be done."""
UNREAD_S = 10.0
"""Time for which a peer may leave its answers unread."""


class Peer(Protocol):
    """One connection to the server."""

    number: int
    """Number of the connection; never used again."""
    name: str
    """Address of the peer."""
    since_s: float
    """Monotonic time of the connection, then of its last request."""
    role: str | None
    """Role in the certificate of the peer."""

    def end(self, why: str) -> None:
        """Close the connection and log why."""

    def drop(self) -> None:
        """Close the connection at once."""


class Peers:
    """Open connections of the server. Use from its loop only."""

    def __init__(self, access: Access, patience_s: float = PATIENCE_S) -> None:
        """`patience_s`: time that a new connection has at least for its first request."""
        self._access, self._right = access, WriteRight(access.writer_idle_s)
        self._patience_s = patience_s
        self._newcomers: dict[int, Peer] = {}
        self._clients: dict[int, Peer] = {}
        self._left = asyncio.Event()
        self._complaints = Complaints()

    def may_connect(self, name: str) -> bool:
        """Return whether an address is on the list of those that may connect, and log if not."""
        if admitted(name, self._access.allow):
            return True
        self.complain(name, "is not on the list plc.allow; connection closed")
        return False

    async def room(self, name: str) -> None:
        """Wait until there is room for a connection from an address; close another one if that is fair."""
        while len(self._newcomers) >= MAX_NEWCOMERS:
            self._left.clear()
            await asyncio.sleep(0)  # what has arrived meanwhile is read before anybody is judged by it
            await asyncio.sleep(0)
            places, now_s = _places(self._newcomers), time.monotonic()
            if len(places) < MAX_NEWCOMERS:
                return
            if (place := newcomer_to_close(places, name, now_s, self._patience_s)) is not None:
                self._newcomers[place.number].end("sent no request while others waited")
                return
            wait_s = min(place.since_s for place in places) + self._patience_s - now_s
            with suppress(TimeoutError):
                await asyncio.wait_for(self._left.wait(), max(wait_s, 0.0) + 0.001)

    def admit(self, peer: Peer) -> None:
        """Count a new connection."""
        peer.since_s = time.monotonic()
        self._newcomers[peer.number] = peer

    def heard(self, peer: Peer) -> None:
        """Count a connection that sends a request as a client; if there are too many, one is closed."""
        peer.since_s = time.monotonic()
        if self._newcomers.pop(peer.number, None) is None:
            return
        self._left.set()
        self._clients[peer.number] = peer
        if len(self._clients) > MAX_CLIENTS:
            place = client_to_close(_places(self._clients), (peer.number, self._right.holder))
            self._clients[place.number].end(f"was silent longest of {MAX_CLIENTS} connections")

    def remove(self, number: int) -> None:
        """Forget a connection that is closed, and its right to write."""
        self._clients.pop(number, None)
        if self._newcomers.pop(number, None) is not None:
            self._left.set()
        self._right.drop(number)

    def drop_all(self) -> None:
        """Close all connections at once, and log what was only counted so far."""
        for peer in [*self._clients.values(), *self._newcomers.values()]:
            peer.drop()
        self._complaints.close()

    def write_refusal(self, number: int) -> int | None:
        """Return None if a connection has, or now gets, the right to write; the exception's code if not."""
        peer = self._clients.get(number)
        if peer is None:
            return BUSY
        if self._access.writers and not admitted(peer.name, self._access.writers):
            self.complain(peer.name, "may not write: it is not on the list plc.writers")
            return ILLEGAL_FUNCTION
        wanted = self._access.writer_role
        if wanted is not None and peer.role != wanted:
            role = "no role" if peer.role is None else f"the role {peer.role}"
            self.complain(peer.name, f"may not write: its certificate has {role}, not {wanted}")
            return ILLEGAL_FUNCTION
        if self._right.take(number, peer.name, time.monotonic()):
            return None
        whose = self._right.address or "another peer"
        advice = "name the PLC under plc.writers"
        self.complain(peer.name, f"may not write: {whose} has the right to write; {advice}")
        return BUSY

    def refused(self, name: str, code: int, request: str) -> None:
        """Log that the values of a request were answered with an exception."""
        self.complain(name, f"got exception {code:02d}, {MEANINGS[code]}", request)

    def refused_write(self, number: int, request: str) -> None:
        """Log that a write outside the writable registers was refused."""
        if (peer := self._clients.get(number)) is not None:
            self.refused(peer.name, ILLEGAL_ADDRESS, request)

    def complain(self, name: str, kind: str, detail: str = "") -> None:
        """Log a complaint about a peer, repetitions as a count."""
        self._complaints.note(name, kind, detail)


def _places(peers: dict[int, Peer]) -> list[Place]:
    return [Place(peer.number, peer.name, peer.since_s) for peer in peers.values()]

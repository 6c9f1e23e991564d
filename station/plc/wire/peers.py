"""The peers of the Modbus server: which may connect, which make room for others, and which one may write."""

import time
from typing import Protocol

from station.plc.wire.access import Access, Complaints, WriteRight, admitted
from station.plc.wire.requests import BUSY, ILLEGAL_ADDRESS, ILLEGAL_FUNCTION, MEANINGS

MAX_PEERS = 128
"""Largest number of open connections; one more closes the one silent longest, but never the writer's."""
HANDSHAKE_S = 10.0
"""Time within which the TLS handshake of a new connection must be done."""
MAX_HANDSHAKES = 16
"""Largest number of TLS handshakes at a time; one more ends the oldest."""
UNREAD_S = 10.0
"""Time for which a peer may leave its answers unread."""


class Peer(Protocol):
    """One connection to the server."""

    number: int
    """Number of the connection; never used again."""
    name: str
    """Address of the peer."""
    heard_s: float
    """Monotonic time of the last request; 0 if there was none yet."""
    role: str | None
    """Role in the certificate of the peer."""

    def end(self, why: str) -> None:
        """Close the connection and log why."""

    def drop(self) -> None:
        """Close the connection at once."""


class Peers:
    """Open connections of the server. Use from its loop only."""

    def __init__(self, access: Access) -> None:
        self._access, self._right = access, WriteRight(access.writer_idle_s)
        self._open: dict[int, Peer] = {}
        self._handshakes: dict[int, Peer] = {}
        self._complaints = Complaints()

    def may_connect(self, peer: Peer) -> bool:
        """Return whether a peer is on the list of those that may connect, and log if not."""
        if admitted(peer.name, self._access.allow):
            return True
        self.complain(peer.name, "is not on the list plc.allow; connection closed")
        return False

    def begin_handshake(self, peer: Peer) -> None:
        """Count a connection whose TLS handshake begins; if there are too many, the oldest is ended."""
        if len(self._handshakes) >= MAX_HANDSHAKES:
            next(iter(self._handshakes.values())).end("did not finish its TLS handshake while others waited")
        self._handshakes[peer.number] = peer

    def admit(self, peer: Peer) -> None:
        """Count an open connection; if there are too many, the most silent one but the writer's is closed."""
        self._handshakes.pop(peer.number, None)
        if len(self._open) >= MAX_PEERS:
            others = (other for other in self._open.values() if other.number != self._right.holder)
            silent = min(others, key=lambda other: other.heard_s)
            silent.end(f"was silent longest of {MAX_PEERS} connections")
        self._open[peer.number] = peer

    def remove(self, number: int) -> None:
        """Forget a connection that is closed, and its right to write."""
        self._open.pop(number, None)
        self._handshakes.pop(number, None)
        self._right.drop(number)

    def drop_all(self) -> None:
        """Close all connections at once, and log what was only counted so far."""
        for peer in [*self._open.values(), *self._handshakes.values()]:
            peer.drop()
        self._complaints.close()

    def write_refusal(self, number: int) -> int | None:
        """Return None if a connection has, or now gets, the right to write; the exception's code if not."""
        peer = self._open.get(number)
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
        if (peer := self._open.get(number)) is not None:
            self.refused(peer.name, ILLEGAL_ADDRESS, request)

    def complain(self, name: str, kind: str, detail: str = "") -> None:
        """Log a complaint about a peer, repetitions as a count."""
        self._complaints.note(name, kind, detail)

"""The peers of the Modbus server: which may connect, which make room for others, and which one may write."""

import time
from collections.abc import Sequence
from typing import Protocol

from station.plc.wire.access import Complaints, Network, WriteRight, admitted

MAX_PEERS = 128
"""Largest number of open connections; one more closes the connection that has been silent longest."""
HANDSHAKE_S = 60.0
"""Time within which a new connection must be set up, TLS handshake included."""
MAX_WAITING = 16
"""Largest number of requests of one peer that wait for their answer."""


class Peer(Protocol):
    """One connection to the server."""

    number: int
    """Number of the connection; never used again."""
    name: str
    """Address of the peer."""
    heard_s: float
    """Monotonic time of the last request; 0 if there was none yet."""

    def end(self, why: str) -> None:
        """Close the connection and log why."""

    def drop(self) -> None:
        """Close the connection at once."""


class Peers:
    """Open connections of the server. Use from its loop only."""

    def __init__(self, *, allow: Sequence[Network], writer_idle_s: float) -> None:
        """`allow`: networks that may connect, or none for all; `writer_idle_s`: as for WriteRight."""
        self._allow, self._right = allow, WriteRight(writer_idle_s)
        self._open: dict[int, Peer] = {}
        self._complaints = Complaints()

    def admit(self, peer: Peer) -> bool:
        """Return whether a new connection may stay; if there are too many, the most silent one is closed."""
        if not admitted(peer.name, self._allow):
            self.complain(peer.name, "is not on the list plc.allow")
            return False
        if len(self._open) >= MAX_PEERS:
            silent = min(self._open.values(), key=lambda other: other.heard_s)
            silent.end(f"was silent longest of {MAX_PEERS} connections")
        self._open[peer.number] = peer
        return True

    def remove(self, number: int) -> None:
        """Forget a connection that is closed, and its right to write."""
        self._open.pop(number, None)
        self._right.drop(number)

    def drop_all(self) -> None:
        """Close all connections at once."""
        for peer in list(self._open.values()):
            peer.drop()

    def may_write(self, number: int) -> bool:
        """Return whether a connection has, or now gets, the right to write."""
        return self._right.take(number, time.monotonic())

    def complain(self, name: str, why: str) -> None:
        """Log why a peer's connection is closed."""
        self._complaints.closed(name, why)

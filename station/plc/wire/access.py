"""Access to the Modbus server: which addresses may connect, who may write, and the log of closed connections.

One peer writes, the others read: the first connection that writes has the right to write until it closes or
has not written for a while.
"""

import logging
import time
from collections.abc import Sequence
from ipaddress import IPv4Network, IPv6Network, ip_address

log = logging.getLogger("weldgate.modbus")

Network = IPv4Network | IPv6Network
REPORT_EVERY_S = 10.0
"""Shortest time between two log entries for the same peer and reason."""
MAX_REMEMBERED = 1000
"""Number of pairs of peer and reason that are remembered; at more, all are forgotten."""


def admitted(address: str, allow: Sequence[Network]) -> bool:
    """Return whether a peer's address is on the list; an empty list admits every address."""
    peer = ip_address(address.split("%")[0])
    mapped = getattr(peer, "ipv4_mapped", None)
    return not allow or any((mapped or peer) in network for network in allow)


class WriteRight:
    """The right to write, held by one connection at a time."""

    def __init__(self, idle_s: float) -> None:
        """`idle_s`: time without a write after which another connection may take the right."""
        self._idle_s = idle_s
        self._holder: int | None = None
        self._wrote_s = 0.0

    def take(self, connection: int, now_s: float) -> bool:
        """Return whether `connection` may write now; each write of the holder renews its right."""
        if self._holder not in (None, connection) and now_s - self._wrote_s <= self._idle_s:
            return False
        self._holder, self._wrote_s = connection, now_s
        return True

    def drop(self, connection: int) -> None:
        """Release the right of a connection that is closed."""
        if self._holder == connection:
            self._holder = None


class Complaints:
    """Log of closed connections that is not flooded: repetitions are counted and reported now and then."""

    def __init__(self) -> None:
        self._seen: dict[tuple[str, str], tuple[int, float]] = {}
        """Number of unreported closures and monotonic time of the last report, by peer and reason."""

    def closed(self, name: str, why: str) -> None:
        """Note that the connection of a peer was closed, and log it if it is time."""
        now_s = time.monotonic()
        unreported, reported_s = self._seen.get((name, why), (0, -REPORT_EVERY_S))
        if now_s - reported_s < REPORT_EVERY_S:
            self._seen[name, why] = unreported + 1, reported_s
            return
        repeated = f" ({unreported} more before)" if unreported else ""
        log.warning("Modbus peer %s %s; connection closed%s", name, why, repeated)
        if len(self._seen) > MAX_REMEMBERED:
            self._seen.clear()
        self._seen[name, why] = 0, now_s

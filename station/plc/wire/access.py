"""Who may connect to the Modbus server, who may write, and what is said of those who misbehave.

One peer writes, others read: the first connection that writes has the right until it closes or has not written for a while.
"""

import logging
import time
from collections.abc import Sequence
from ipaddress import IPv4Network, IPv6Network, ip_address

log = logging.getLogger("weldgate.modbus")

Network = IPv4Network | IPv6Network
TOLD_S, MAX_TOLD = 10.0, 1000


def admitted(address: str, allow: Sequence[Network]) -> bool:
    """Whether a peer's address is on the list; an empty list admits all."""
    peer = ip_address(address.split("%")[0])
    mapped = getattr(peer, "ipv4_mapped", None)
    return not allow or any((mapped or peer) in network for network in allow)


class WriteRight:
    """The right to write, held by one connection at a time."""

    def __init__(self, idle_s: float) -> None:
        self._idle_s = idle_s
        self._holder: int | None = None
        self._wrote_s = 0.0

    def take(self, connection: int, now_s: float) -> bool:
        """Whether `connection` may write now; a write of the holder renews its right."""
        if self._holder not in (None, connection) and now_s - self._wrote_s <= self._idle_s:
            return False
        self._holder, self._wrote_s = connection, now_s
        return True

    def drop(self, connection: int) -> None:
        """The connection is closed."""
        if self._holder == connection:
            self._holder = None


class Complaints:
    """Why connections are closed, for the log; a flood of the same is told once in a while, with its number."""

    def __init__(self) -> None:
        self._told: dict[tuple[str, str], tuple[int, float]] = {}
        """Of each peer and reason: how often untold, and when told last."""

    def closed(self, name: str, why: str) -> None:
        """A peer's connection is closed."""
        now = time.monotonic()
        untold, told_s = self._told.get((name, why), (0, -TOLD_S))
        if now - told_s < TOLD_S:
            self._told[name, why] = untold + 1, told_s
            return
        log.warning(
            "Modbus peer %s %s; connection closed%s", name, why, f" ({untold} more before)" if untold else ""
        )
        if len(self._told) > MAX_TOLD:
            self._told.clear()
        self._told[name, why] = 0, now

"""Access to the Modbus server: which addresses may connect, who may write, and the log about peers.

One peer writes, the others read: the first connection that writes has the right to write until it has not
written for a while; one that closes can be followed at once from the same address alone.
"""

import asyncio
import logging
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from ipaddress import IPv4Network, IPv6Network, ip_address

log = logging.getLogger("weldgate.modbus")

Network = IPv4Network | IPv6Network
REPORT_EVERY_S = 10.0
"""Shortest time between two log entries for the same peer and the same kind of complaint."""
MAX_REMEMBERED = 1000
"""Number of pairs of peer and kind that are counted apart; the others are counted together."""
OTHERS = "others"
"""Peer under whose name further peers are counted."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Access:
    """What peers of the server may do."""

    allow: Sequence[Network] = ()
    """Networks that may connect; empty: all."""
    writers: Sequence[Network] = ()
    """Networks that may write; empty: all that may connect."""
    writer_idle_s: float = float("inf")
    """Time without a write after which another peer may take the right to write."""
    writer_role: str | None = None
    """Role that a writer's certificate must have; None: any."""


EVERYBODY = Access()
"""Access without limits."""


def admitted(address: str, networks: Sequence[Network]) -> bool:
    """Return whether a peer's address is on the list; an empty list admits every address."""
    peer = ip_address(address.split("%")[0])
    mapped = getattr(peer, "ipv4_mapped", None)
    return not networks or any((mapped or peer) in network for network in networks)


def open_to_all(host: str, allow: Sequence[Network]) -> str | None:
    """Return a sentence if a server at an address lets every machine connect that reaches it, else None."""
    local = host == "localhost"
    with suppress(ValueError):
        local = ip_address(host).is_loopback
    if allow or local:
        return None
    return f"plc.allow is empty: every machine that reaches {host} may connect; name the PLC under plc.allow"


class WriteRight:
    """The right to write, held by one connection at a time.

    A connection that closes leaves the right to its address for the idle time: a PLC that connects again gets
    it back, and another peer does not slip in between.
    """

    def __init__(self, idle_s: float) -> None:
        """`idle_s`: time without a write after which another connection may take the right."""
        self._idle_s = idle_s
        self.holder: int | None = None
        self.address: str | None = None
        """Address of the last holder."""
        self._wrote_s = 0.0

    def take(self, connection: int, address: str, now_s: float) -> bool:
        """Return whether `connection` may write now; each write of the holder renews its right."""
        own = self.holder == connection or (self.holder is None and self.address in (None, address))
        if not own and now_s - self._wrote_s <= self._idle_s:
            return False
        self.holder, self.address, self._wrote_s = connection, address, now_s
        return True

    def drop(self, connection: int) -> None:
        """Take the right from a connection that is closed; its address keeps it for the idle time."""
        if self.holder == connection:
            self.holder = None


class Complaints:
    """Log about peers that is not flooded: the first of a kind is logged at once, repetitions as a count.

    Use from one loop.
    """

    def __init__(self) -> None:
        self._seen: dict[tuple[str, str], tuple[int, str]] = {}
        """Number of unreported repetitions and the last detail, by peer and kind."""
        self._next: asyncio.TimerHandle | None = None
        self._reported_s = 0.0

    def note(self, name: str, kind: str, detail: str = "") -> None:
        """Note a complaint about a peer; `detail` may differ within a kind."""
        key = (name, kind)
        if key not in self._seen and len(self._seen) >= MAX_REMEMBERED:
            key = (OTHERS, kind)
        if key in self._seen:
            self._seen[key] = self._seen[key][0] + 1, detail
        else:
            self._seen[key] = 0, detail
            log.warning("Modbus peer %s %s%s", key[0], kind, f" ({detail})" if detail else "")
        if self._next is None:
            self._reported_s = time.monotonic()
            self._next = asyncio.get_running_loop().call_later(REPORT_EVERY_S, self.report)

    def report(self) -> None:
        """Log the counts of what was repeated, and forget what was not."""
        if self._next is not None:
            self._next.cancel()
            self._next = None
        elapsed_s, self._reported_s = time.monotonic() - self._reported_s, time.monotonic()
        repeated = {key: found for key, found in self._seen.items() if found[0]}
        for (name, kind), (count, detail) in repeated.items():
            last = f", the last: {detail}" if detail else ""
            log.warning("Modbus peer %s %s: %d more in %.0f s%s", name, kind, count, elapsed_s, last)
        self._seen = dict.fromkeys(repeated, (0, ""))
        if repeated:
            self._next = asyncio.get_running_loop().call_later(REPORT_EVERY_S, self.report)

    def close(self) -> None:
        """Log what was only counted so far, and end."""
        self.report()
        if self._next is not None:
            self._next.cancel()
            self._next = None

"""Which connection makes room for another one; pure.

A connection is a newcomer until its first whole request, then a client. Newcomers never cost a client its
place, and clients never cost a newcomer its own. A newcomer that was not given time to send its request is
closed only for an address that holds fewer places: who floods the server waits for itself.
"""

from collections import Counter
from collections.abc import Collection
from dataclasses import dataclass

MAX_CLIENTS = 128
"""Largest number of connections that have sent a request."""
MAX_NEWCOMERS = 128
"""Largest number of connections that have not yet sent one; further ones wait in the queue of the system."""
PATIENCE_S, TLS_PATIENCE_S = 0.5, 3.0
"""Time that a newcomer has at least for its first request, plain and with a TLS handshake before it."""


@dataclass(frozen=True, slots=True)
class Place:
    """A connection that counts."""

    number: int
    """Number of the connection."""
    address: str
    since_s: float
    """Monotonic time of the last request of a client; of a newcomer, when it connected."""


def newcomer_to_close(
    newcomers: Collection[Place], address: str, now_s: float, patience_s: float
) -> Place | None:
    """Return which newcomer makes room for a connection from `address`; None: it must wait.

    That is the oldest of the address with most of them, if that address stays ahead; else the oldest of all,
    if it had its time.
    """
    held = Counter(place.address for place in newcomers)
    most = max(held.values())
    oldest = min((place for place in newcomers if held[place.address] == most), key=_since)
    if held[oldest.address] > held[address] + 1:
        return oldest
    oldest = min(newcomers, key=_since)
    return oldest if now_s - oldest.since_s > patience_s else None


def client_to_close(clients: Collection[Place], kept: Collection[int | None]) -> Place:
    """Return which client makes room for another one: of the address with most of them, the most silent one.

    `kept`: numbers of connections that stay, which is not all of them.
    """
    held = Counter(place.address for place in clients)
    others = [place for place in clients if place.number not in kept]
    return min(others, key=lambda place: (-held[place.address], place.since_s))


def _since(place: Place) -> float:
    return place.since_s

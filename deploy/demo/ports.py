"""Finds free ports on loopback for the demo, the benchmarks and the tests."""

import atexit
import os
import socket
from collections import deque

RESERVED = 64
"""Number of ports that stay reserved for servers that are still starting."""
_reserved: deque[socket.socket] = deque()


def free_ports(count: int) -> list[int]:
    """Return free ports on loopback that no other process gets until `RESERVED` more have been requested.

    On POSIX a socket that is bound but does not listen reserves a port, and a server can still listen on it.
    """
    if not _reserved:
        atexit.register(_give_back)
    entries = [socket.socket() for _ in range(count)]
    for entry in entries:
        if os.name == "posix":
            entry.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        entry.bind(("127.0.0.1", 0))
    ports = [int(entry.getsockname()[1]) for entry in entries]
    _reserved.extend(entries)
    while len(_reserved) > (RESERVED if os.name == "posix" else 0):
        _reserved.popleft().close()
    return ports


def _give_back() -> None:
    while _reserved:
        _reserved.popleft().close()

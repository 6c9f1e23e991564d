"""Requests of one peer in their order; while too many wait, nothing more is read from it.

TCP then holds the rest back at the peer: no request is lost and no memory fills.
"""

import asyncio
from collections import deque

from station.plc.wire.framing import frames

MAX_WAITING = 16
"""Largest number of requests of one peer that wait for their answer."""


class Inbox:
    """Bytes that arrive, split into whole requests. Use from one loop only."""

    def __init__(self) -> None:
        self._bytes = b""
        self._frames: deque[bytes] = deque()
        self._arrived = asyncio.Event()
        self._transport: asyncio.ReadTransport | None = None
        self._paused = False
        self.problem: str | None = None
        """What is wrong after the last request; None: nothing. Nothing is taken in after it."""

    def attach(self, transport: asyncio.ReadTransport) -> None:
        """Use this transport to hold the peer back."""
        self._transport = transport

    def feed(self, data: bytes) -> bool:
        """Take in bytes that have arrived; return whether a whole request came with them."""
        self._bytes += data
        return self._split()

    async def next(self) -> bytes | None:
        """Return the next whole request; None if anything else follows."""
        while not self._frames and self.problem is None:
            self._arrived.clear()
            await self._arrived.wait()
        if not self._frames:
            return None
        frame = self._frames.popleft()
        if not self._frames:
            self._split()
        return frame

    def _split(self) -> bool:
        found: list[bytes] = []
        if self.problem is None:
            found, used, self.problem = frames(self._bytes, MAX_WAITING - len(self._frames))
            self._bytes = self._bytes[used:]
            self._frames.extend(found)
        self._hold(len(self._frames) >= MAX_WAITING or self.problem is not None)
        self._arrived.set()
        return bool(found)

    def _hold(self, paused: bool) -> None:
        if self._transport is not None and paused != self._paused and not self._transport.is_closing():
            self._paused = paused
            (self._transport.pause_reading if paused else self._transport.resume_reading)()

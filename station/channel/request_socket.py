"""Requests of windows and their answers over a Unix socket that keeps messages apart (SOCK_SEQPACKET).

What a window sends waits in the memory of its own account, in the kernel, until it is read: one message of
each window in turn, of limited size and at a limited rate. So no peer takes the engine's memory or time.
"""

import selectors
import socket
import struct
import time
from collections import deque
from contextlib import suppress
from dataclasses import dataclass

from pydantic import TypeAdapter, ValidationError

from station.channel.requests import Answer, Message
from station.channel.sockets import SOCKET_MODE, Claim, Peer, check_folder, socket_path
from station.errors import LineError
from station.settings.model import ChannelSettings

REQUESTS = "requests"
"""Name of the socket in the channel's folder."""
MAX_REQUESTS = 10
"""Number of requests that are received at once; each may take some milliseconds."""
REQUESTS_PER_S = 200
"""Number of messages per second that are read; the others wait."""
MAX_BYTES = 65_536
"""Maximum length of a request; the sender of a longer one is disconnected."""
MAX_ANSWER_BYTES = 65_536
"""Maximum length of an answer."""
MAX_WINDOWS, MAX_OF_PROCESS = 32, 8
"""Number of connections at the same time: all of them, and those of one process."""
RETRY_S = 0.1
"""Time between two attempts to connect."""

_MESSAGE = TypeAdapter(Message)
_ANSWER = TypeAdapter(Answer)
_CREDENTIALS = struct.Struct("3i")


@dataclass(frozen=True, slots=True)
class Incoming:
    """A request as it was received."""

    sender: int
    """Number of the connection, for the answer."""
    peer: Peer
    """Account and process that opened the connection, as the system reports them."""
    message: Message


@dataclass(frozen=True, slots=True)
class _Window:
    number: int
    peer: Peer
    socket: socket.socket


class RequestServer:
    """The engine's end for requests; answers go to the window that asked. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Listen. Raises LineError if another engine does, or everybody could ask."""
        path = socket_path(settings.folder, REQUESTS)
        self._claim = Claim(settings.folder, REQUESTS)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._selector = selectors.DefaultSelector()
        self._windows: dict[int, _Window] = {}
        self._turn: deque[int] = deque()
        """Numbers of the connections, the one that waits longest first."""
        self._last, self._next_s = 0, 0.0
        try:
            path.unlink(missing_ok=True)  # left by an engine that was killed: the claim is ours
            self._socket.bind(str(path))
            path.chmod(SOCKET_MODE)
            self._socket.listen(MAX_WINDOWS)
        except OSError as error:
            self.close()
            raise LineError(
                f"the channel cannot listen on {path} ({error.strerror}); set channel.folder"
            ) from None
        self._socket.setblocking(False)
        self._selector.register(self._socket, selectors.EVENT_READ)

    def received(self, wait_s: float) -> list[Incoming]:
        """Return the requests received, of each window in turn; invalid ones are dropped.

        `wait_s`: longest wait for the first one.
        """
        pause_s = self._next_s - time.monotonic()
        if pause_s > 0:
            time.sleep(min(pause_s, wait_s))
            if pause_s > wait_s:
                return []
        ready = {key.data for key, _ in self._selector.select(wait_s)}
        found: list[Incoming] = []
        count = 0
        if None in ready:
            self._accept()
            count += 1
        for number in [number for number in self._turn if number in ready][:MAX_REQUESTS]:
            self._turn.remove(number)
            self._turn.append(number)
            count += 1
            window = self._windows[number]
            raw = self._read(window)
            with suppress(ValidationError):
                if raw is not None:
                    found.append(Incoming(number, window.peer, _MESSAGE.validate_json(raw, strict=True)))
        self._next_s = time.monotonic() + count / REQUESTS_PER_S
        return found

    def _accept(self) -> None:
        with suppress(OSError):
            opened, _ = self._socket.accept()
            opened.setblocking(False)
            raw = opened.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
            process, account, _ = _CREDENTIALS.unpack(raw)
            same = sum(window.peer.process == process for window in self._windows.values())
            if len(self._windows) >= MAX_WINDOWS or same >= MAX_OF_PROCESS:
                opened.close()
                return
            self._last += 1
            self._windows[self._last] = _Window(self._last, Peer(account, process), opened)
            self._turn.append(self._last)
            self._selector.register(opened, selectors.EVENT_READ, self._last)

    def _read(self, window: _Window) -> bytes | None:
        """Return one message; None if there is none. A window that is gone, or sends too much, is dropped."""
        try:
            raw, _, flags, _ = window.socket.recvmsg(MAX_BYTES)
        except BlockingIOError:
            return None
        except OSError:
            raw, flags = b"", 0
        if not raw or flags & socket.MSG_TRUNC:
            self._drop(window)
            return None
        return raw

    def _drop(self, window: _Window) -> None:
        self._selector.unregister(window.socket)
        window.socket.close()
        del self._windows[window.number]
        self._turn.remove(window.number)

    def answer(self, sender: int, answer: Answer) -> None:
        """Send an answer to a window; it is dropped if the window is closed or does not read."""
        window = self._windows.get(sender)
        if window is not None:
            with suppress(OSError):
                window.socket.send(_ANSWER.dump_json(answer))

    def close(self) -> None:
        """Close all connections."""
        for window in list(self._windows.values()):
            self._drop(window)
        self._selector.close()
        self._socket.close()
        self._claim.release()


class RequestClient:
    """A window's end for requests; nothing is queued while the engine is down. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Connect; reconnects automatically. Raises LineError if this account may not, or everybody may."""
        check_folder(settings.folder)
        self._path = socket_path(settings.folder, REQUESTS)
        self._socket: socket.socket | None = None
        self._next_s = 0.0

    def _connection(self) -> socket.socket | None:
        """Return the connection to the engine; None if there is none just now."""
        if self._socket is None and time.monotonic() >= self._next_s:
            made = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            made.setblocking(False)
            try:
                made.connect(str(self._path))
            except OSError:
                made.close()
                self._next_s = time.monotonic() + RETRY_S
            else:
                self._socket = made
        return self._socket

    def _disconnect(self) -> None:
        if self._socket is not None:
            self._socket.close()
        self._socket, self._next_s = None, time.monotonic() + RETRY_S

    def send(self, message: Message) -> bool:
        """Send a request; return False if there is no connection to the engine, or its queue is full."""
        raw = _MESSAGE.dump_json(message)
        connection = self._connection()
        if connection is None:
            return False
        try:
            connection.send(raw)
        except BlockingIOError:
            return False
        except OSError:
            self._disconnect()
            return False
        return True

    def answers(self) -> list[Answer]:
        """Return all answers received; those of another version are dropped."""
        found: list[Answer] = []
        while (connection := self._connection()) is not None:
            try:
                raw = connection.recv(MAX_ANSWER_BYTES)
            except BlockingIOError:
                break
            except OSError:
                raw = b""
            if not raw:
                self._disconnect()
                break
            with suppress(ValidationError):
                found.append(_ANSWER.validate_json(raw, strict=True))
        return found

    def close(self) -> None:
        """Close the connection; what was sent is still received."""
        self._disconnect()

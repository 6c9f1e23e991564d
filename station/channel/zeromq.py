"""Local channel between engine and windows over ZeroMQ; the only file that imports zmq.

Events are queued; of the previews only the latest is delivered; each request of a window is answered. The
engine never waits for a window, and windows may start and stop at any time.
"""

from contextlib import suppress
from typing import Annotated

import zmq
from pydantic import Field, TypeAdapter, ValidationError

from station.channel.events import Event, Preview
from station.channel.requests import Answer, Message
from station.errors import LineError
from station.settings.model import ChannelSettings

_EVENTS: TypeAdapter[Event] = TypeAdapter(Annotated[Event, Field(discriminator="type")])
_PREVIEW = TypeAdapter(Preview)
_MESSAGE = TypeAdapter(Message)
_ANSWER = TypeAdapter(Answer)
MAX_REQUESTS = 10
"""Number of requests that are received at once; each may take some milliseconds."""
MAX_BYTES = 65_536
"""Maximum length of a request; the sender of a longer one is disconnected."""
LINGER_MS = 200
"""Time within which the last request of a closing window must be sent."""


def _address(settings: ChannelSettings, port: int) -> str:
    host = f"[{settings.host}]" if settings.host.version == 6 else str(settings.host)
    return f"tcp://{host}:{port}"


def _bind(
    context: "zmq.Context[zmq.Socket[bytes]]", socket: "zmq.Socket[bytes]", address: str, key: str
) -> None:
    """Listen on a port. Raises LineError if it is in use; then nothing stays open."""
    try:
        socket.bind(address)
    except zmq.ZMQError as error:
        context.destroy(linger=0)
        raise LineError(
            f"the channel cannot listen on {address} ({error}); free the port or set channel.{key}"
        ) from None


class Publisher:
    """The engine's end for events and previews. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Listen. Raises LineError if a port is in use."""
        self._context = zmq.Context()
        self._events = self._socket(1000)
        self._previews = self._socket(2)
        for socket, port, key in (
            (self._events, settings.events_port, "events_port"),
            (self._previews, settings.preview_port, "preview_port"),
        ):
            _bind(self._context, socket, _address(settings, port), key)

    def _socket(self, high_water: int) -> "zmq.Socket[bytes]":
        socket = self._context.socket(zmq.PUB)
        socket.setsockopt(zmq.SNDHWM, high_water)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.IPV6, 1)
        return socket

    def send(self, event: Event) -> None:
        """Send an event; it is dropped for a window that is 1000 events behind."""
        self._events.send(_EVENTS.dump_json(event))

    def show(self, preview: Preview) -> None:
        """Send a preview; it is dropped for a window that is behind."""
        self._previews.send(_PREVIEW.dump_json(preview))

    def close(self) -> None:
        """Close both sockets."""
        self._context.destroy(linger=0)


class Subscriber:
    """A window's end for events and previews; reconnects automatically. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        self._context = zmq.Context()
        self._events = self._socket(settings, settings.events_port, latest_only=False)
        self._previews = self._socket(settings, settings.preview_port, latest_only=True)

    def _socket(self, settings: ChannelSettings, port: int, latest_only: bool) -> "zmq.Socket[bytes]":
        socket = self._context.socket(zmq.SUB)
        if latest_only:
            socket.setsockopt(zmq.CONFLATE, 1)
        socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
        socket.setsockopt(zmq.SUBSCRIBE, b"")
        socket.setsockopt(zmq.IPV6, 1)
        socket.connect(_address(settings, port))
        return socket

    def events(self) -> list[Event]:
        """Return all events received; those of another version are dropped."""
        found: list[Event] = []
        while (raw := self._receive(self._events)) is not None:
            try:
                found.append(_EVENTS.validate_json(raw, strict=True))
            except ValidationError:
                continue
        return found

    def preview(self) -> Preview | None:
        """Return the newest preview; None if there is no new one."""
        raw = self._receive(self._previews)
        try:
            return None if raw is None else _PREVIEW.validate_json(raw, strict=True)
        except ValidationError:
            return None

    @staticmethod
    def _receive(socket: "zmq.Socket[bytes]") -> bytes | None:
        try:
            return socket.recv(zmq.NOBLOCK)
        except zmq.Again:
            return None

    def close(self) -> None:
        """Close both sockets."""
        self._context.destroy(linger=0)


class RequestServer:
    """The engine's end for requests; answers go to the window that asked. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Listen. Raises LineError if the port is in use."""
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.ROUTER)
        for option, value in ((zmq.MAXMSGSIZE, MAX_BYTES), (zmq.LINGER, 0), (zmq.IPV6, 1)):
            self._socket.setsockopt(option, value)
        _bind(self._context, self._socket, _address(settings, settings.requests_port), "requests_port")

    def received(self, wait_s: float) -> list[tuple[bytes, Message]]:
        """Return the requests received, each with its sender; invalid ones are dropped.

        `wait_s`: longest wait for the first one.
        """
        found: list[tuple[bytes, Message]] = []
        if not self._socket.poll(int(wait_s * 1000)):
            return found
        for _ in range(MAX_REQUESTS):
            try:
                frames = self._socket.recv_multipart(zmq.NOBLOCK)
            except zmq.Again:
                break
            with suppress(ValidationError):
                if len(frames) == 2:
                    found.append((frames[0], _MESSAGE.validate_json(frames[1], strict=True)))
        return found

    def answer(self, sender: bytes, answer: Answer) -> None:
        """Send an answer to a window; it is dropped if the window is closed or does not read."""
        with suppress(zmq.ZMQError):
            self._socket.send_multipart((sender, _ANSWER.dump_json(answer)), zmq.NOBLOCK)

    def close(self) -> None:
        """Close the socket."""
        self._context.destroy(linger=0)


class RequestClient:
    """A window's end for requests; nothing is queued while the engine is down. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Connect; reconnects automatically."""
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.DEALER)
        for option, value in (
            (zmq.IMMEDIATE, 1),
            (zmq.SNDHWM, 100),
            (zmq.IPV6, 1),
            (zmq.RECONNECT_IVL_MAX, 1000),
        ):
            self._socket.setsockopt(option, value)
        self._socket.connect(_address(settings, settings.requests_port))

    def send(self, message: Message) -> bool:
        """Send a request; return False if there is no connection to the engine."""
        try:
            self._socket.send(_MESSAGE.dump_json(message), zmq.NOBLOCK)
        except zmq.Again:
            return False
        return True

    def answers(self) -> list[Answer]:
        """Return all answers received; those of another version are dropped."""
        found: list[Answer] = []
        while True:
            try:
                raw = self._socket.recv(zmq.NOBLOCK)
            except zmq.Again:
                return found
            with suppress(ValidationError):
                found.append(_ANSWER.validate_json(raw, strict=True))

    def close(self) -> None:
        """Close the socket after the last request was sent."""
        self._context.destroy(linger=LINGER_MS)

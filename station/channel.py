"""Local channel between engine and panels over ZeroMQ; the only file that imports it.

Events are queued; previews ride a latest-only slot; requests go the other way. The engine never waits for a panel, and a panel may
come and go.
"""

import time
from contextlib import suppress
from typing import Annotated

import zmq
from pydantic import Field, TypeAdapter, ValidationError

from station.errors import LineError
from station.events import Event, Preview
from station.requests import Request
from station.settings import ChannelSettings

_EVENTS: TypeAdapter[Event] = TypeAdapter(Annotated[Event, Field(discriminator="type")])
_PREVIEW = TypeAdapter(Preview)
_REQUEST: TypeAdapter[Request] = TypeAdapter(Annotated[Request, Field(discriminator="type")])
MAX_REQUESTS = 100
"""Looked at in one go."""
FRESH_S = 2.0
"""An older request is not carried out: whoever asked has seen that nothing came."""


def _address(settings: ChannelSettings, port: int) -> str:
    host = f"[{settings.host}]" if settings.host.version == 6 else str(settings.host)
    return f"tcp://{host}:{port}"


def _bind(context: "zmq.Context[zmq.Socket[bytes]]", socket: "zmq.Socket[bytes]", address: str, key: str) -> None:
    """Listen; if the port is taken nothing stays open. Raises LineError."""
    try:
        socket.bind(address)
    except zmq.ZMQError as error:
        context.destroy(linger=0)
        raise LineError(f"channel cannot listen on {address} ({error}); free it or set channel.{key}") from None


class Publisher:
    """The engine's end. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Bind. Raises LineError if a port is taken."""
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
        """Queue an event; dropped for a panel that is 1000 behind."""
        self._events.send(_EVENTS.dump_json(event))

    def show(self, preview: Preview) -> None:
        """Offer a picture; dropped for a panel that is behind."""
        self._previews.send(_PREVIEW.dump_json(preview))

    def close(self) -> None:
        """Close both sockets."""
        self._context.destroy(linger=0)


class Subscriber:
    """A panel's end; connects and reconnects by itself. Use from one thread."""

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
        """All events that have come; those of another version are dropped."""
        found: list[Event] = []
        while (raw := self._receive(self._events)) is not None:
            try:
                found.append(_EVENTS.validate_json(raw))
            except ValidationError:
                continue
        return found

    def preview(self) -> Preview | None:
        """The newest picture, if a new one has come."""
        raw = self._receive(self._previews)
        try:
            return None if raw is None else _PREVIEW.validate_json(raw)
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


class Inbox:
    """Where the engine finds what panels ask for. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Bind. Raises LineError if the port is taken."""
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.PULL)
        self._socket.setsockopt(zmq.IPV6, 1)
        _bind(self._context, self._socket, _address(settings, settings.requests_port), "requests_port")

    def requests(self) -> list[Request]:
        """What was asked for just now, of each kind the last."""
        found: dict[str, Request] = {}
        for _ in range(MAX_REQUESTS):
            try:
                raw = self._socket.recv(zmq.NOBLOCK)
            except zmq.Again:
                break
            with suppress(ValidationError):
                request = _REQUEST.validate_json(raw)
                if abs(time.time() - request.asked_s) <= FRESH_S:
                    found[request.type] = request
        return list(found.values())

    def close(self) -> None:
        """Close the socket."""
        self._context.destroy(linger=0)


class Outbox:
    """Where a panel asks. Nothing is kept for an engine that is not there. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.PUSH)
        for option, value in ((zmq.IMMEDIATE, 1), (zmq.SNDHWM, 2), (zmq.LINGER, 0), (zmq.IPV6, 1), (zmq.RECONNECT_IVL_MAX, 1000)):
            self._socket.setsockopt(option, value)
        self._socket.connect(_address(settings, settings.requests_port))

    def ask(self, request: Request) -> bool:
        """False if no engine is there."""
        try:
            self._socket.send(_REQUEST.dump_json(request), zmq.NOBLOCK)
        except zmq.Again:
            return False
        return True

    def close(self) -> None:
        """Close the socket."""
        self._context.destroy(linger=0)

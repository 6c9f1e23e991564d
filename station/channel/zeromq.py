"""Events and previews from engine to windows, over ZeroMQ and Unix sockets; the only file that imports zmq.

Events are queued; of the previews only the latest is delivered. The engine never waits for a window, and
windows may start and stop at any time.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import zmq
from pydantic import Field, TypeAdapter, ValidationError

from station.channel.events import Event, Preview
from station.channel.sockets import SOCKET_MODE, Claim, address, check_folder
from station.errors import LineError
from station.settings.model import ChannelSettings

_EVENTS: TypeAdapter[Event] = TypeAdapter(Annotated[Event, Field(discriminator="type")])
_PREVIEW = TypeAdapter(Preview)
EVENTS, PREVIEWS = "events", "previews"
"""Names of the sockets in the channel's folder."""
MAX_SUBSCRIPTION_BYTES = 255
"""Maximum length of what a window sends to a socket of events; it only says that it listens."""
MAX_WAITING = 100
"""Number of such messages of a window that wait."""


def _bind(
    context: "zmq.Context[zmq.Socket[bytes]]", folder: Path, sockets: "Mapping[str, zmq.Socket[bytes]]"
) -> Claim:
    """Listen in the folder and return the claim to it. Raises LineError; then nothing stays open."""
    claim = None
    try:
        claim = Claim(folder, next(iter(sockets)))
        for name, socket in sockets.items():
            socket.bind(address(folder, name))
            (folder.resolve() / name).chmod(SOCKET_MODE)
    except (zmq.ZMQError, OSError, LineError) as error:
        context.destroy(linger=0)
        if claim is not None:
            claim.release()
        if isinstance(error, LineError):
            raise
        raise LineError(
            f"the channel cannot listen in {folder} ({error.strerror}); set channel.folder to another folder"
        ) from None
    return claim


class Publisher:
    """The engine's end for events and previews. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Listen. Raises LineError if another engine does, or everybody could."""
        self._context = zmq.Context()
        self._events = self._socket(1000)
        self._previews = self._socket(2)
        sockets = {EVENTS: self._events, PREVIEWS: self._previews}
        self._claim = _bind(self._context, settings.folder, sockets)

    def _socket(self, high_water: int) -> "zmq.Socket[bytes]":
        socket = self._context.socket(zmq.PUB)
        for option, value in (
            (zmq.SNDHWM, high_water),
            (zmq.RCVHWM, MAX_WAITING),
            (zmq.MAXMSGSIZE, MAX_SUBSCRIPTION_BYTES),
            (zmq.LINGER, 0),
        ):
            socket.setsockopt(option, value)
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
        self._claim.release()


class Subscriber:
    """A window's end for events and previews; reconnects automatically. Use from one thread."""

    def __init__(self, settings: ChannelSettings) -> None:
        """Connect. Raises LineError if this account may not use the channel, or everybody may."""
        check_folder(settings.folder)
        events, previews = address(settings.folder, EVENTS), address(settings.folder, PREVIEWS)
        self._context = zmq.Context()
        self._events = self._socket(events, latest_only=False)
        self._previews = self._socket(previews, latest_only=True)

    def _socket(self, place: str, latest_only: bool) -> "zmq.Socket[bytes]":
        socket = self._context.socket(zmq.SUB)
        if latest_only:
            socket.setsockopt(zmq.CONFLATE, 1)
        socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
        socket.setsockopt(zmq.SUBSCRIBE, b"")
        socket.connect(place)
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

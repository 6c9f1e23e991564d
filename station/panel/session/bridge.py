"""Turns what comes over the engine's channel into Qt signals; polls on the window's thread, never waits."""

from PySide6.QtCore import QObject, QTimer, Signal

from station.channel.events import PartEvent, StatusEvent
from station.channel.request_socket import RequestClient
from station.channel.requests import Message
from station.channel.zeromq import Subscriber

POLL_MS = 30


class Bridge(QObject):
    """Emits the events and answers of the engine, and sends requests to it."""

    status = Signal(object)
    """Carries a StatusEvent."""
    parts = Signal(object)
    """Carries the PartEvents that came at once, the newest last."""
    setup_image = Signal(object)
    """Carries the numbers of a setup image."""
    preview = Signal(object)
    """Carries a Preview."""
    answer = Signal(object)
    """Carries the Answer to one request."""

    def __init__(self, subscriber: Subscriber, client: RequestClient) -> None:
        super().__init__()
        self._subscriber, self._client = subscriber, client
        self._timer = QTimer(self)
        self._timer.timeout.connect(self.poll)
        self._timer.start(POLL_MS)

    def poll(self) -> None:
        """Emit what has come; called regularly."""
        if not self._timer.isActive():  # closed while this call was waiting
            return
        parts: list[PartEvent] = []
        for event in self._subscriber.events():
            if isinstance(event, StatusEvent):
                self.status.emit(event)
            elif isinstance(event, PartEvent):
                parts.append(event)
            else:
                self.setup_image.emit(event)
        if parts:
            self.parts.emit(parts)
        if not self._timer.isActive():  # closed by what was emitted
            return
        for answer in self._client.answers():
            self.answer.emit(answer)
        if not self._timer.isActive():
            return
        preview = self._subscriber.preview()
        if preview is not None:
            self.preview.emit(preview)

    def send(self, message: Message) -> bool:
        """Send a request. Return False if there is no connection to the engine."""
        return self._client.send(message)

    def close(self) -> None:
        """Stop polling and close the channel."""
        self._timer.stop()
        self._subscriber.close()
        self._client.close()

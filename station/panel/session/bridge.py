"""From the engine's channel to Qt signals: the only crossing. Polls on the window's own thread, never waits."""

from PySide6.QtCore import QObject, QTimer, Signal

from station.channel.events import PartEvent, StatusEvent
from station.channel.requests import Message
from station.channel.zeromq import RequestClient, Subscriber

POLL_MS = 30


class Bridge(QObject):
    """Emits what the engine says."""

    status = Signal(object)
    """StatusEvent"""
    parts = Signal(object)
    """PartEvents that came at once, the newest last."""
    look = Signal(object)
    """LookEvent"""
    preview = Signal(object)
    """Preview"""
    answer = Signal(object)
    """Answer to one request"""

    def __init__(self, subscriber: Subscriber, client: RequestClient) -> None:
        super().__init__()
        self._subscriber, self._client = subscriber, client
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._poll)
        self._timer.start(POLL_MS)

    def _poll(self) -> None:
        parts: list[PartEvent] = []
        for event in self._subscriber.events():
            if isinstance(event, StatusEvent):
                self.status.emit(event)
            elif isinstance(event, PartEvent):
                parts.append(event)
            else:
                self.look.emit(event)
        if parts:
            self.parts.emit(parts)
        for answer in self._client.answers():
            self.answer.emit(answer)
        preview = self._subscriber.preview()
        if preview is not None:
            self.preview.emit(preview)

    def send(self, message: Message) -> bool:
        """Send a request. Return False if there is no connection to the engine."""
        return self._client.send(message)

    def close(self) -> None:
        """Stop listening."""
        self._timer.stop()
        self._subscriber.close()
        self._client.close()

"""Sends requests to the engine and calls back with the answer; the window never waits."""

import time

import shiboken6
from PySide6.QtCore import QObject, QTimer

from station.channel.requests import Answer, Message, Request
from station.panel.session.bridge import Bridge
from station.panel.session.pending import NO_CONNECTION, Pending, Then

CHECK_MS = 250
"""Interval at which requests are given up that will not be answered any more."""


class EngineRequests(QObject):
    """Sends requests and knows who waits for their answers."""

    def __init__(self, bridge: Bridge) -> None:
        super().__init__()
        self._bridge, self._pending = bridge, Pending()
        bridge.answer.connect(self._on_answer)
        for event in (bridge.status, bridge.parts, bridge.setup_image):
            event.connect(self._on_event)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._give_up_lost)
        self._timer.start(CHECK_MS)

    def ask(self, request: Request, token: str, then: Then, owner: QObject | None = None) -> None:
        """Send a request with the token of a login.

        `then` is called once with the answer, unless its `owner` was deleted meanwhile.
        """
        now_s = time.monotonic()
        number = self._pending.begin(guarded(then, owner), now_s)
        if not self._bridge.send(Message(number, now_s, request, token)):
            self._give_up(number)

    def _on_answer(self, answer: Answer) -> None:
        then = self._pending.answered(answer, time.monotonic())
        if then is not None:
            then(answer)

    def _on_event(self, _event: object) -> None:
        self._pending.heard(time.monotonic())

    def _give_up_lost(self) -> None:
        self._bridge.poll()  # a window that was busy itself has not yet read what came meanwhile
        for number in self._pending.lost(time.monotonic()):
            self._give_up(number)

    def _give_up(self, number: int) -> None:
        then = self._pending.given_up(number)
        if then is not None:
            then(Answer(number, NO_CONNECTION))

    def close(self) -> None:
        """Stop waiting for answers."""
        self._timer.stop()


def guarded(then: Then, owner: QObject | None) -> Then:
    """Return a function that calls `then` unless its owner was deleted meanwhile, as pages are at times."""

    def call(answer: Answer) -> None:
        if owner is None or shiboken6.isValid(owner):
            then(answer)

    return call

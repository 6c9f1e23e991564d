"""Asks the engine, and calls back with the one answer; the window never waits."""

import time

import shiboken6
from PySide6.QtCore import QObject, QTimer

from station.channel.requests import Answer, Message, Request
from station.panel.session.bridge import Bridge
from station.panel.session.pending import NO_CONNECTION, Pending, Then

LOOK_MS = 250


class EngineRequests(QObject):
    """Sends requests and knows who waits for their answers."""

    def __init__(self, bridge: Bridge) -> None:
        super().__init__()
        self._bridge, self._pending = bridge, Pending()
        bridge.answer.connect(self._on_answer)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._look)
        self._timer.start(LOOK_MS)

    def ask(self, request: Request, token: str, then: Then, owner: QObject | None = None) -> None:
        """Ask by a login's token; `then` is called once, unless its `owner` was deleted meanwhile."""
        now_s = time.monotonic()
        number = self._pending.begin(guarded(then, owner), now_s)
        if not self._bridge.send(Message(number, now_s, request, token)):
            self._give_up(number)

    def _on_answer(self, answer: Answer) -> None:
        then = self._pending.answered(answer, time.monotonic())
        if then is not None:
            then(answer)

    def _look(self) -> None:
        for number in self._pending.lost(time.monotonic()):
            self._give_up(number)

    def _give_up(self, number: int) -> None:
        then = self._pending.given_up(number)
        if then is not None:
            then(Answer(number, NO_CONNECTION))

    def close(self) -> None:
        """Stop waiting."""
        self._timer.stop()


def guarded(then: Then, owner: QObject | None) -> Then:
    """Return what calls `then` unless its owner was deleted meanwhile: pages are made again at times."""

    def alive(answer: Answer) -> None:
        if owner is None or shiboken6.isValid(owner):
            then(answer)

    return alive

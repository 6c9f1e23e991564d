"""Sends requests to the engine and calls back with the answer; the window never waits."""

import time
from collections import deque
from dataclasses import dataclass

import shiboken6
from PySide6.QtCore import QObject, QTimer

from station.channel.requests import Answer, Message, Request
from station.panel.session.bridge import Bridge
from station.panel.session.pending import NO_CONNECTION, Pending, Then

CHECK_MS = 100
"""Interval at which requests are sent that wait for the connection, or given up."""


@dataclass(frozen=True, slots=True)
class _Unsent:
    number: int
    request: Request
    token: str


class EngineRequests(QObject):
    """Sends requests and knows who waits for their answers.

    Events and requests have connections of their own. A request for an engine whose events come waits until
    its connection is there too; one for an engine that is not there is given up at once.
    """

    def __init__(self, bridge: Bridge) -> None:
        super().__init__()
        self._bridge, self._pending = bridge, Pending()
        self._unsent: deque[_Unsent] = deque()
        bridge.answer.connect(self._on_answer)
        for event in (bridge.status, bridge.parts, bridge.setup_image):
            event.connect(self._on_event)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._check)
        self._timer.start(CHECK_MS)

    def ask(self, request: Request, token: str, then: Then, owner: QObject | None = None) -> None:
        """Send a request with the token of a login.

        `then` is called once with the answer, unless its `owner` was deleted meanwhile.
        """
        now_s = time.monotonic()
        number = self._pending.begin(guarded(then, owner), now_s)
        self._unsent.append(_Unsent(number, request, token))
        self._send_unsent()
        if self._unsent and not self._pending.is_heard(now_s):
            self._unsent.pop()
            self._give_up(number)

    def _send_unsent(self) -> None:
        """Send what waits for the connection, in order, as far as it can be sent."""
        while self._unsent:
            first = self._unsent[0]
            if not self._bridge.send(Message(first.number, time.monotonic(), first.request, first.token)):
                return
            self._unsent.popleft()

    def _on_answer(self, answer: Answer) -> None:
        then = self._pending.answered(answer, time.monotonic())
        if then is not None:
            then(answer)

    def _on_event(self, _event: object) -> None:
        self._pending.heard(time.monotonic())

    def _check(self) -> None:
        self._bridge.poll()  # a window that was busy itself has not yet read what came meanwhile
        self._send_unsent()
        now_s = time.monotonic()
        unsent = {waiting.number for waiting in self._unsent}
        for number in self._pending.lost(now_s, unsent):
            self._unsent = deque(waiting for waiting in self._unsent if waiting.number != number)
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

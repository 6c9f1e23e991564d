"""Requests that wait for the engine: each is answered once, by the engine or because it is gone; pure."""

from collections.abc import Callable
from dataclasses import dataclass

from station.channel.requests import Answer

NO_CONNECTION = "no connection to the engine"
PATIENCE_S = 5.0
"""An engine that answers nothing for so long is gone; one answer may last while others come."""

Then = Callable[[Answer], None]


@dataclass(frozen=True, slots=True)
class _Waiting:
    then: Then
    asked_s: float


class Pending:
    """Knows who waits for which answer; times are monotonic."""

    def __init__(self) -> None:
        self._last, self._heard_s = 0, -1e9
        self._waiting: dict[int, _Waiting] = {}

    def begin(self, then: Then, now_s: float) -> int:
        """Return the number of a new request; `then` is called with its answer."""
        self._last += 1
        self._waiting[self._last] = _Waiting(then, now_s)
        return self._last

    def answered(self, answer: Answer, now_s: float) -> Then | None:
        """Return who waits for this answer; None: nobody does any more."""
        self._heard_s = now_s
        waiting = self._waiting.pop(answer.request_id, None)
        return None if waiting is None else waiting.then

    def given_up(self, request_id: int) -> Then | None:
        """Forget a request that could not be sent; return who waits for it."""
        waiting = self._waiting.pop(request_id, None)
        return None if waiting is None else waiting.then

    def lost(self, now_s: float) -> list[int]:
        """Return the numbers of requests that will not be answered: the engine is gone."""
        late_s = now_s - PATIENCE_S
        return [n for n, waiting in self._waiting.items() if max(waiting.asked_s, self._heard_s) < late_s]

"""Requests that wait for the engine: each gets one answer, if need be that there is no connection; pure."""

from collections.abc import Callable, Collection
from dataclasses import dataclass

from station.channel.requests import Answer

NO_CONNECTION = "No connection to the engine."
"""Answer to a request that the engine did not answer."""
SILENCE_S = 5.0
"""Time without events and answers after which the engine is considered lost."""
NO_ANSWER_S = 60.0
"""Time without any answer after which requests are given up, although events come."""
NEVER_S = -1e9

Then = Callable[[Answer], None]
"""Function that is called once with the answer to a request."""


@dataclass(frozen=True, slots=True)
class _Waiting:
    then: Then
    asked_s: float


class Pending:
    """Knows who waits for which answer; times are monotonic.

    A busy engine answers late: as long as its events come, requests wait. An answer may take even longer
    while others come.
    """

    def __init__(self) -> None:
        self._last, self._heard_s, self._answered_s = 0, NEVER_S, NEVER_S
        self._waiting: dict[int, _Waiting] = {}

    def begin(self, then: Then, now_s: float) -> int:
        """Return the number of a new request; `then` is called with its answer."""
        self._last += 1
        self._waiting[self._last] = _Waiting(then, now_s)
        return self._last

    def heard(self, now_s: float) -> None:
        """Note that the engine has sent an event."""
        self._heard_s = now_s

    def is_heard(self, now_s: float) -> bool:
        """Return whether the engine has sent anything lately."""
        return now_s - self._heard_s <= SILENCE_S

    def answered(self, answer: Answer, now_s: float) -> Then | None:
        """Return who waits for this answer, or None if nobody does any more."""
        self._heard_s = self._answered_s = now_s
        waiting = self._waiting.pop(answer.request_id, None)
        return None if waiting is None else waiting.then

    def given_up(self, request_id: int) -> Then | None:
        """Forget a request that will not be answered; return who waits for it."""
        waiting = self._waiting.pop(request_id, None)
        return None if waiting is None else waiting.then

    def lost(self, now_s: float, unsent: Collection[int] = ()) -> list[int]:
        """Return the numbers of the requests that will not be answered any more.

        Those in `unsent` could not be sent yet; they do not wait longer than `SILENCE_S`.
        """
        return [
            number
            for number, waiting in self._waiting.items()
            if self._is_lost(waiting, now_s) or (number in unsent and now_s - waiting.asked_s > SILENCE_S)
        ]

    def _is_lost(self, waiting: _Waiting, now_s: float) -> bool:
        silent_s = now_s - max(waiting.asked_s, self._heard_s)
        unanswered_s = now_s - max(waiting.asked_s, self._answered_s)
        return silent_s > SILENCE_S or unanswered_s > NO_ANSWER_S

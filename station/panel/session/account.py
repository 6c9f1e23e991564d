"""The login of this window: the engine grants it, checks it with each request, and ends it."""

from functools import partial

from PySide6.QtCore import QObject, QTimer, Signal

from station.channel.requests import Answer, LogIn, LogOut, Request, StayLoggedIn
from station.journal.users import Level, User
from station.panel.session.engine_requests import EngineRequests, guarded
from station.panel.session.login_state import LoginState
from station.panel.session.pending import Then
from station.panel.session.received import Received

RENEW_MS = 1000
"""Interval at which the login is renewed."""


class Account(QObject):
    """Knows who is logged in and sends requests to the engine in their name."""

    changed = Signal()
    """Emitted when somebody has logged in or out."""

    def __init__(self, requests: EngineRequests, received: Received) -> None:
        super().__init__()
        self._requests, self._received, self._state = requests, received, LoginState()
        self._renew = QTimer(self)
        self._renew.timeout.connect(self.renew)
        self._idle = QTimer(self)
        self._idle.setSingleShot(True)
        self._idle.timeout.connect(lambda: self._leave(LogOut("idle")))  # also while no engine is there

    @property
    def user(self) -> User | None:
        """User who is logged in, or None."""
        return self._state.user

    def may(self, level: Level) -> bool:
        """Return whether a user with at least this level is logged in; the engine checks it again."""
        return self._state.may(level)

    def ask(self, request: Request, then: Then, owner: QObject | None = None) -> None:
        """Send a request in the name of the user who is logged in; `then` is called once with the answer."""
        self._requests.ask(request, self._state.token, then, owner)

    def log_in(
        self, name: str, pin: str, then: Then, owner: QObject | None = None, *, code: str = ""
    ) -> None:
        """Ask for a login; it lasts until logout, another login, or a time without use of the window.

        `code`: commissioning code that makes this user an administrator first, or empty.
        """
        reply = guarded(then, owner)

        def answered(answer: Answer) -> None:
            if self._state.begin(answer):
                self.touched()
                self._renew.start(RENEW_MS)
                self.changed.emit()
            reply(answer)

        self.ask(LogIn(name, pin, code), answered)

    def log_out(self) -> None:
        """End the login, and service mode with it."""
        self._leave(LogOut("asked to"))

    def _leave(self, request: LogOut) -> None:
        if self.user is not None:
            self.ask(request, _nothing)
            self._end()

    def _end(self) -> None:
        self._renew.stop()
        self._idle.stop()
        if self._state.end():
            self.changed.emit()

    def touched(self) -> None:
        """Note that the window is being used, which keeps the user logged in."""
        if self.user is not None:
            self._state.touched()
            self._idle.start(int(self._received.settings.panel.logout_min * 60_000))

    def renew(self) -> None:
        """Renew the login; the answer says whether the engine has ended it."""
        token = self._state.token
        self.ask(StayLoggedIn(self._state.take_touched()), partial(self._on_renewed, token))

    def _on_renewed(self, token: str, answer: Answer) -> None:
        if self._state.is_ended_by(token, answer):
            self._end()

    def close(self) -> None:
        """Log out and stop the timers."""
        self._leave(LogOut("window closed"))
        self._renew.stop()
        self._idle.stop()


def _nothing(_answer: Answer) -> None:
    """Ignore an answer that nobody waits for."""

"""Logins by token; a login ends when its window is closed or unused for some time; pure."""

import secrets
from collections.abc import Callable
from dataclasses import dataclass, replace

from station.journal.users import User

WINDOW_LOST_S = 15.0
"""Time without a request after which a window counts as closed, killed or hanging."""


@dataclass(frozen=True, slots=True)
class Login:
    """One login, with the monotonic times of its last use by a person and of its last request."""

    user: User
    used_s: float
    requested_s: float


class Logins:
    """The present logins by token."""

    def __init__(self, idle_s: Callable[[], float]) -> None:
        """`idle_s` returns the time without use after which a login ends."""
        self._idle_s = idle_s
        self._logins: dict[str, Login] = {}

    def begin(self, user: User, now_s: float) -> str:
        """Begin a login and return its token."""
        token = secrets.token_urlsafe(24)
        self._logins[token] = Login(user, now_s, now_s)
        return token

    def user(self, token: str, now_s: float) -> User | None:
        """Return the user of a login; None if it is unknown or has ended."""
        login = self._logins.get(token)
        return None if login is None or self._why_ended(login, now_s) else login.user

    def renew(self, token: str, used: bool, now_s: float) -> None:
        """Note a request of a window; `used`: a person has used the window."""
        if self.user(token, now_s) is not None:
            login = self._logins[token]
            used_s = now_s if used else login.used_s
            self._logins[token] = replace(login, requested_s=now_s, used_s=used_s)

    def end(self, token: str) -> User | None:
        """End a login and return its user; None if it is unknown."""
        login = self._logins.pop(token, None)
        return None if login is None else login.user

    def ended(self, now_s: float) -> list[tuple[str, str]]:
        """Return the tokens whose time is over, each with the reason; they are held until `end`."""
        return [
            (token, why) for token, login in self._logins.items() if (why := self._why_ended(login, now_s))
        ]

    def tokens(self, name: str | None = None) -> list[str]:
        """Return the tokens of one user, or of all users."""
        return [token for token, login in self._logins.items() if name in (None, login.user.name)]

    def _why_ended(self, login: Login, now_s: float) -> str:
        if now_s - login.used_s > self._idle_s():
            return "idle"
        return "window closed" if now_s - login.requested_s > WINDOW_LOST_S else ""

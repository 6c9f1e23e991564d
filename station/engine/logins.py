"""Who is logged in: tokens of the engine that end when a window is gone or nobody touches it; pure."""

import secrets
from collections.abc import Callable
from dataclasses import dataclass, replace

from station.journal.users import User

GONE_S = 15.0
"""A window that has not asked for anything for so long was closed, killed or hangs."""


@dataclass(frozen=True, slots=True)
class Login:
    """One login, with the monotonic times at which the window was last touched and last heard."""

    user: User
    touched_s: float
    heard_s: float


class Logins:
    """All logins by their tokens."""

    def __init__(self, idle_s: Callable[[], float]) -> None:
        """`idle_s` returns after how long without a touch a login ends."""
        self._idle_s = idle_s
        self._held: dict[str, Login] = {}

    def begin(self, user: User, now_s: float) -> str:
        """Return the token of a new login."""
        token = secrets.token_urlsafe(24)
        self._held[token] = Login(user, now_s, now_s)
        return token

    def user(self, token: str, now_s: float) -> User | None:
        """Return whose login it is; None: it is unknown, or has ended."""
        login = self._held.get(token)
        return None if login is None or self._why_over(login, now_s) else login.user

    def heard(self, token: str, touched: bool, now_s: float) -> None:
        """Note that the window has asked for something; `touched`: because somebody used it."""
        if self.user(token, now_s) is not None:
            login = self._held[token]
            self._held[token] = replace(login, heard_s=now_s, touched_s=now_s if touched else login.touched_s)

    def end(self, token: str) -> User | None:
        """End a login and return whose it was."""
        login = self._held.pop(token, None)
        return None if login is None else login.user

    def over(self, now_s: float) -> list[tuple[str, str]]:
        """Return the tokens whose time is over, each with the reason; they are held until `end`."""
        return [(token, why) for token, login in self._held.items() if (why := self._why_over(login, now_s))]

    def tokens(self, name: str | None = None) -> list[str]:
        """Return the tokens of a user, or all."""
        return [token for token, login in self._held.items() if name in (None, login.user.name)]

    def _why_over(self, login: Login, now_s: float) -> str:
        if now_s - login.touched_s > self._idle_s():
            return "idle"
        return "window closed" if now_s - login.heard_s > GONE_S else ""

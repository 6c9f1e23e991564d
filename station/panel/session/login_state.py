"""Who is logged in at this window, as the engine says; pure."""

from station.channel.requests import Answer
from station.journal.users import Level, User
from station.panel.session.pending import NO_CONNECTION


class LoginState:
    """Token and user of the login, and whether somebody has used the window since the last renewal."""

    def __init__(self) -> None:
        self.token = ""
        """Token that the engine handed out; empty: nobody is logged in."""
        self.user: User | None = None
        self._touched = False

    def may(self, level: Level) -> bool:
        """Return whether who is logged in may do what this level may; the engine checks it again."""
        return self.user is not None and self.user.level >= level

    def begun(self, answer: Answer) -> bool:
        """Take in the answer to a login. Return whether somebody is logged in by it."""
        if answer.done and answer.token and answer.level is not None:
            self.token, self.user, self._touched = answer.token, User(answer.name, answer.level), False
            return True
        return False

    def ended(self) -> bool:
        """Forget the login. Return whether there was one."""
        there = self.user is not None
        self.token, self.user, self._touched = "", None, False
        return there

    def touched(self) -> None:
        """Note that somebody uses the window."""
        self._touched = self.user is not None

    def take_touched(self) -> bool:
        """Return whether somebody has used the window since this was last asked."""
        touched, self._touched = self._touched, False
        return touched

    def over_by(self, token: str, answer: Answer) -> bool:
        """Return whether an answer to a renewal of `token` says that this login has ended."""
        return token == self.token != "" and not answer.logged_in and answer.refusal != NO_CONNECTION

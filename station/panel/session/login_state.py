"""The login of this window as the engine reports it; pure."""

from station.channel.requests import Answer
from station.journal.users import Level, User
from station.panel.session.pending import NO_CONNECTION


class LoginState:
    """Token and user of the login, and whether the window was used since the last renewal."""

    def __init__(self) -> None:
        self.token = ""
        """Token that the engine granted; empty if nobody is logged in."""
        self.user: User | None = None
        self._touched = False

    def may(self, level: Level) -> bool:
        """Return whether a user with at least this level is logged in; the engine checks it again."""
        return self.user is not None and self.user.level >= level

    def begin(self, answer: Answer) -> bool:
        """Use the answer to a login. Return whether somebody is logged in by it."""
        if answer.done and answer.token and answer.level is not None:
            self.token, self.user, self._touched = answer.token, User(answer.name, answer.level), False
            return True
        return False

    def end(self) -> bool:
        """Forget the login. Return whether there was one."""
        was_logged_in = self.user is not None
        self.token, self.user, self._touched = "", None, False
        return was_logged_in

    def touched(self) -> None:
        """Note that the window is being used."""
        self._touched = self.user is not None

    def take_touched(self) -> bool:
        """Return whether the window was used since the last call."""
        touched, self._touched = self._touched, False
        return touched

    def is_ended_by(self, token: str, answer: Answer) -> bool:
        """Return whether the answer to a renewal of `token` means that this login has ended."""
        return token == self.token != "" and not answer.logged_in and answer.refusal != NO_CONNECTION

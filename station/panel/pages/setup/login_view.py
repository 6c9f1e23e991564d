"""What the login page offers by the users that are known, and what it says of a refusal; pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from station.channel.requests import Answer
from station.journal.users import User


class Said(StrEnum):
    """What has to be said of an answer to a login."""

    NOTHING = "nothing"
    LOCKED = "locked"
    REFUSED = "refused"


@dataclass(frozen=True, slots=True)
class LoginView:
    """Choices of the page."""

    first: bool
    """True if nobody is known: who logs in becomes administrator."""
    names: tuple[str, ...]
    chosen: str
    """Name that is filled in."""


def login_view(known: Sequence[User], typed: str) -> LoginView:
    """Return what the page offers; what was typed stays."""
    names = tuple(user.name for user in known)
    return LoginView(not names, names, typed or (names[0] if names else ""))


def said(answer: Answer) -> Said:
    """Return what to say of an answer; the words of a lock name seconds, which age on the screen."""
    if answer.done:
        return Said.NOTHING
    return Said.LOCKED if answer.locked_s > 0 else Said.REFUSED

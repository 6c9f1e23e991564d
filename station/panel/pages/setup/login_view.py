"""What the tab Login offers, by the users of the station, and how it reports a refusal; pure."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

from station.channel.requests import Answer
from station.journal.users import User


class Notice(StrEnum):
    """Kind of message that an answer to a login needs."""

    NOTHING = "nothing"
    LOCKED = "locked"
    REFUSED = "refused"


@dataclass(frozen=True, slots=True)
class LoginView:
    """Choices of the tab."""

    first: bool
    """True if there are no users: the first needs a commissioning code."""
    names: tuple[str, ...]
    """Names to choose from."""
    chosen: str
    """Name in the field."""


def login_view(known: Sequence[User], typed: str) -> LoginView:
    """Return what the tab offers; a name that was typed stays."""
    names = tuple(user.name for user in known)
    return LoginView(not names, names, typed or (names[0] if names else ""))


def needs_code(known: Sequence[User], typed: str) -> bool:
    """Return whether a name is of nobody yet, who can only log in with a commissioning code."""
    return not known or (bool(typed) and all(user.name != typed for user in known))


def notice(answer: Answer) -> Notice:
    """Return which message an answer needs.

    A lock has one of its own: its refusal names the seconds left, which would soon be wrong on the screen.
    """
    if answer.done:
        return Notice.NOTHING
    return Notice.LOCKED if answer.locked_s > 0 else Notice.REFUSED

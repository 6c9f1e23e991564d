"""Users of the station and their levels, stored in the journal; only `accounts` changes them."""

from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from pydantic import TypeAdapter

from station.errors import RecordError
from station.journal.journal import NAME, Kind, entries


class Level(IntEnum):
    """Level of a user; each one has the rights of those before it."""

    OPERATOR = 1
    SETTER = 2
    """May use camera, service mode and masters."""
    QUALITY = 3
    """May change thresholds and give second reviews."""
    ADMIN = 4
    """May change users."""


@dataclass(frozen=True, slots=True)
class User:
    """A user of the station."""

    name: str
    level: Level


@dataclass(frozen=True, slots=True)
class StoredUser:
    """A user as stored in the journal: the level, and a salted hash of the PIN."""

    level: Level
    salt: str
    hash: str
    keyed: bool = False
    """True if the hash is made with the key of the installation, False for PINs of earlier versions."""


_USER = TypeAdapter(StoredUser)


def users(folder: Path) -> list[User]:
    """Return all users, sorted by name. Raises RecordError."""
    return [User(name, stored.level) for name, stored in sorted(stored_users(folder).items())]


def stored_users(folder: Path) -> dict[str, StoredUser]:
    """Return the users by name, each from its newest entry. Raises RecordError."""
    last: dict[str, str] = {}
    for entry in entries(folder, (Kind.USER,), newest_first=False):
        last[entry.subject] = entry.after
    try:
        return {name: _USER.validate_json(after, strict=True) for name, after in last.items() if after}
    except ValueError:
        raise RecordError(
            f"{folder / NAME}: the entry of a user cannot be read; restore the journal"
        ) from None

"""Who may do what at the station: names and levels, kept in the journal; read here, `accounts` alone changes them."""

import json
from dataclasses import dataclass
from enum import IntEnum
from pathlib import Path

from station.journal.journal import Kind, entries


class Level(IntEnum):
    """Rank of a user; each level may do what the ones before may."""

    OPERATOR = 1
    SETTER = 2
    """Camera, service mode, masters."""
    QUALITY = 3
    """Thresholds, second reviews."""
    ADMIN = 4
    """Users."""


@dataclass(frozen=True, slots=True)
class User:
    """Someone known to the station."""

    name: str
    level: Level


@dataclass(frozen=True, slots=True)
class Kept:
    """What the journal keeps of a user: the level, and a salted hash of the PIN."""

    level: Level
    salt: str
    hash: str


def users(folder: Path) -> list[User]:
    """Return all who may log in, by name. Raises RecordError."""
    return [User(name, kept.level) for name, kept in sorted(kept_users(folder).items())]


def kept_users(folder: Path) -> dict[str, Kept]:
    """Return what the newest entry of each name says. Raises RecordError."""
    last: dict[str, str] = {}
    for entry in entries(folder, (Kind.USER,), newest_first=False):
        last[entry.subject] = entry.after
    found = {name: json.loads(after) for name, after in last.items() if after}
    return {name: Kept(Level(k["level"]), k["salt"], k["hash"]) for name, k in found.items()}

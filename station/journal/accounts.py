"""Changes users and checks PINs; used by the engine only. A deterrent on a local machine, not a fortress."""

import hashlib
import hmac
import json
import secrets
from datetime import UTC, datetime, timedelta
from pathlib import Path

from station.errors import LoginError
from station.journal.journal import Entry, Kind, entries
from station.journal.journal_writer import append
from station.journal.users import Level, StoredUser, User, stored_users

TRIES, LOCKED_S = 5, 60.0
"""Number of wrong PINs within a time that lock a name, and that time."""
MIN_DIGITS, MAX_DIGITS = 4, 12
"""Shortest and longest PIN."""


def save_user(folder: Path, name: str, *, level: Level, pin: str, by: str) -> User:
    """Add a user, or change the level and PIN of a user. Raises LoginError, RecordError.

    `by`: name of the user who does it.
    """
    name = name.strip()
    if not 1 <= len(name) <= 40 or not name.isprintable():
        raise LoginError("a name of 1 to 40 characters is needed")
    if not (pin.isascii() and pin.isdigit() and MIN_DIGITS <= len(pin) <= MAX_DIGITS):
        raise LoginError(f"a PIN of {MIN_DIGITS} to {MAX_DIGITS} digits is needed")
    stored = stored_users(folder)
    if level is not Level.ADMIN and not _another_admin(stored, name):
        raise LoginError("at least one administrator is needed")
    salt = secrets.token_hex(16)
    after = json.dumps({"level": int(level), "salt": salt, "hash": _hash(pin, salt)})
    append(folder, Kind.USER, by, name, before=_level_of(stored, name), after=after)
    return User(name, level)


def remove_user(folder: Path, name: str, *, by: str) -> None:
    """Remove a user. Raises LoginError for the last administrator or an unknown name, RecordError."""
    stored = stored_users(folder)
    if name not in stored:
        raise LoginError(f"user {name} does not exist")
    if not _another_admin(stored, name):
        raise LoginError("at least one administrator is needed")
    append(folder, Kind.USER, by, name, before=_level_of(stored, name))


def log_in(folder: Path, name: str, pin: str, *, source: str = "") -> User:
    """Check a PIN. Raises LoginError if it is wrong, or the name is locked after wrong PINs; RecordError.

    `source`: account and process of this machine that asks; it is written to the journal.
    """
    last = entries(folder, (Kind.LOGIN, Kind.LOGIN_FAILED), name, limit=TRIES)
    tries = [entry for entry in last if _age(entry) < timedelta(seconds=LOCKED_S)]
    if len(tries) == TRIES and all(entry.kind is Kind.LOGIN_FAILED for entry in tries):
        left_s = LOCKED_S - _age(tries[0]).total_seconds()
        why = f"{name} is locked for another {left_s:.0f} s after {TRIES} wrong PINs"
        raise LoginError(why, locked_s=left_s)
    stored = stored_users(folder).get(name)
    if stored is None or not hmac.compare_digest(_hash(pin, stored.salt), stored.hash):
        append(folder, Kind.LOGIN_FAILED, name, name, reason=source)
        raise LoginError("unknown name or wrong PIN")
    append(folder, Kind.LOGIN, name, name, reason=source)
    return User(name, stored.level)


def log_out(folder: Path, user: User, why: str) -> None:
    """Note in the journal that a user has logged out, and why. Raises RecordError."""
    append(folder, Kind.LOGOUT, user.name, user.name, reason=why)


def _another_admin(stored: dict[str, StoredUser], name: str) -> bool:
    return any(user.level is Level.ADMIN for other, user in stored.items() if other != name)


def _level_of(stored: dict[str, StoredUser], name: str) -> str:
    return stored[name].level.name.lower() if name in stored else ""


def _age(entry: Entry) -> timedelta:
    return datetime.now(UTC) - datetime.fromisoformat(entry.at)


def _hash(pin: str, salt: str) -> str:
    return hashlib.scrypt(pin.encode(), salt=bytes.fromhex(salt), n=2**14, r=8, p=1).hex()

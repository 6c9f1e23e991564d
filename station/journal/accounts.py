"""Changes users and checks PINs: for the engine alone. A deterrent on a local machine, not a fortress."""

import hashlib
import hmac
import json
import secrets
from datetime import UTC, datetime, timedelta
from pathlib import Path

from station.errors import LoginError
from station.journal.journal import Entry, Kind, entries
from station.journal.journal_writer import append
from station.journal.users import Kept, Level, User, kept_users

TRIES, LOCKED_S = 5, 60.0
MIN_DIGITS, MAX_DIGITS = 4, 12


def save_user(folder: Path, by: str, name: str, level: Level, pin: str) -> User:
    """Add a user, or give a known one another level and PIN. Raises LoginError saying why not, RecordError."""
    name = name.strip()
    if not 1 <= len(name) <= 40 or not name.isprintable():
        raise LoginError("a name of 1 to 40 characters is needed")
    if not (pin.isascii() and pin.isdigit() and MIN_DIGITS <= len(pin) <= MAX_DIGITS):
        raise LoginError(f"a PIN of {MIN_DIGITS} to {MAX_DIGITS} digits is needed")
    kept = kept_users(folder)
    if level is not Level.ADMIN and not _another_admin(kept, name):
        raise LoginError("at least one administrator is needed")
    salt = secrets.token_hex(16)
    after = json.dumps({"level": int(level), "salt": salt, "hash": _hash(pin, salt)})
    append(folder, Kind.USER, by, name, _level_of(kept, name), after)
    return User(name, level)


def remove_user(folder: Path, by: str, name: str) -> None:
    """Remove a user. Raises LoginError if it is the last administrator or unknown, RecordError."""
    kept = kept_users(folder)
    if name not in kept:
        raise LoginError(f"there is no user {name}")
    if not _another_admin(kept, name):
        raise LoginError("at least one administrator is needed")
    append(folder, Kind.USER, by, name, _level_of(kept, name), "")


def log_in(folder: Path, name: str, pin: str) -> User:
    """Check a PIN. Raises LoginError if it is wrong, or was five times in the last minute; RecordError."""
    last = entries(folder, (Kind.LOGIN, Kind.LOGIN_FAILED), name, limit=TRIES)
    tries = [e for e in last if _age(e) < timedelta(seconds=LOCKED_S)]
    if len(tries) == TRIES and all(e.kind is Kind.LOGIN_FAILED for e in tries):
        left_s = LOCKED_S - _age(tries[0]).total_seconds()
        why = f"{name} is locked for {left_s:.0f} s more after {TRIES} wrong PINs"
        raise LoginError(why, locked_s=left_s)
    kept = kept_users(folder).get(name)
    if kept is None or not hmac.compare_digest(_hash(pin, kept.salt), kept.hash):
        append(folder, Kind.LOGIN_FAILED, name, name)
        raise LoginError("unknown name or wrong PIN")
    append(folder, Kind.LOGIN, name, name)
    return User(name, kept.level)


def log_out(folder: Path, user: User, why: str) -> None:
    """Note that a user has left, and why. Raises RecordError."""
    append(folder, Kind.LOGOUT, user.name, user.name, reason=why)


def _another_admin(kept: dict[str, Kept], name: str) -> bool:
    return any(k.level is Level.ADMIN for n, k in kept.items() if n != name)


def _level_of(kept: dict[str, Kept], name: str) -> str:
    return kept[name].level.name.lower() if name in kept else ""


def _age(entry: Entry) -> timedelta:
    return datetime.now(UTC) - datetime.fromisoformat(entry.at)


def _hash(pin: str, salt: str) -> str:
    return hashlib.scrypt(pin.encode(), salt=bytes.fromhex(salt), n=2**14, r=8, p=1).hex()

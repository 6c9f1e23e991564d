"""Changes users and checks PINs; used by the engine only."""

import threading
import time
from collections.abc import Callable
from pathlib import Path

from pydantic import TypeAdapter

from station.errors import LoginError, RecordError
from station.journal.commissioning import is_code, use_up
from station.journal.journal import Kind, entries
from station.journal.journal_writer import append
from station.journal.pins import MIN_DIGITS, check_pin, is_pin, stored_pin
from station.journal.tries import TRIES, Tries
from station.journal.users import Level, StoredUser, User, stored_users
from station.log import visible

MAX_NAME = 40
"""Length of the longest name."""
UNKNOWN, CODE = "", "\0code"
"""Names under which tries of unknown names and of commissioning codes are counted; no user has them."""
WRONG = "unknown name or wrong PIN"
"""Refusal of a login; it does not say whether the name is known."""
WRONG_CODE = "wrong commissioning code: 'weldgate commission' makes one"
"""Refusal of a code."""
NO_USERS = "there are no users yet: enter the code that 'weldgate commission' makes"
"""Refusal of a login without a code at a station without users."""
TOO_SHORT = (
    "this PIN is too short for the level: an administrator must set one of 6 digits; "
    "'weldgate commission' makes a new administrator"
)
"""Refusal of a PIN of an earlier version."""
_USER = TypeAdapter(StoredUser)


class Accounts:
    """Users of one station. May be used from several threads; the engine has one object."""

    def __init__(self, folder: Path, keys: Path, *, clock: Callable[[], float] = time.monotonic) -> None:
        """`folder`: the archive with the journal; `keys`: folder of the installation's keys."""
        self._folder, self._keys = folder, keys
        self._lock = threading.Lock()
        """Held while users are read and changed by what was read."""
        self._tries = Tries(clock, self._locked_before())

    def _locked_before(self) -> list[str]:
        """Return the names whose last tries failed: a restart of the engine gives nobody further tries."""
        try:
            last = entries(self._folder, (Kind.LOGIN, Kind.LOGIN_FAILED), limit=100 * TRIES)
            known = stored_users(self._folder)
        except RecordError:  # reported where a person logs in
            return []
        kinds: dict[str, list[Kind]] = {}
        for entry in last:
            name = entry.subject if entry.subject in known else UNKNOWN
            kinds.setdefault(name, []).append(entry.kind)
        failed = [Kind.LOGIN_FAILED] * TRIES
        return [name for name, newest in kinds.items() if newest[:TRIES] == failed]

    def save_user(self, name: str, *, level: Level, pin: str, by: str) -> User:
        """Add a user, or change the level and PIN of a user. Raises LoginError, RecordError.

        `by`: name of the user who does it.
        """
        with self._lock:
            return self._save(name, level=level, pin=pin, by=by)

    def _save(self, name: str, *, level: Level, pin: str, by: str, reason: str = "") -> User:
        name = name.strip()
        if not _is_name(name):
            raise LoginError("a name of 1 to 40 characters is needed")
        check_pin(pin, level)
        stored = stored_users(self._folder)
        if level is not Level.ADMIN and not _another_admin(stored, name):
            raise LoginError("at least one administrator is needed")
        after = _USER.dump_json(stored_pin(self._keys, level, pin)).decode()
        before = _level_of(stored, name)
        append(self._folder, Kind.USER, by, name, before=before, after=after, reason=reason)
        return User(name, level)

    def remove_user(self, name: str, *, by: str) -> None:
        """Remove a user. Raises LoginError for the last administrator or an unknown name, RecordError."""
        with self._lock:
            stored = stored_users(self._folder)
            if name not in stored:
                raise LoginError(f"user {name} does not exist")
            if not _another_admin(stored, name):
                raise LoginError("at least one administrator is needed")
            append(self._folder, Kind.USER, by, name, before=_level_of(stored, name))

    def log_in(self, name: str, pin: str, *, source: str = "") -> User:
        """Check a PIN. Raises LoginError if it is wrong, or the name is locked after wrong PINs; RecordError.

        `source`: account and process of this machine that asks; it is written to the journal.
        """
        stored = stored_users(self._folder)
        if not stored:
            raise LoginError(NO_USERS)
        known = stored.get(name)
        self._tries.begin(name, bucket=UNKNOWN if known is None else None)
        if not is_pin(self._keys, known, pin) or known is None:
            append(self._folder, Kind.LOGIN_FAILED, visible(name), visible(name), reason=source)
            raise LoginError(WRONG)
        if len(pin) < MIN_DIGITS[known.level]:
            append(self._folder, Kind.LOGIN_FAILED, name, name, reason="too short")
            raise LoginError(TOO_SHORT)
        append(self._folder, Kind.LOGIN, name, name, reason=source)
        self._tries.succeeded(name)
        return User(name, known.level)

    def commission(self, name: str, pin: str, code: str, *, source: str = "") -> User:
        """Add an administrator by a commissioning code, which is used up. Raises LoginError, RecordError."""
        name = name.strip()
        with self._lock:
            self._tries.begin(name, bucket=CODE)
            if name in stored_users(self._folder):
                raise LoginError("this name exists: enter another one for the new administrator")
            if not _is_name(name):
                raise LoginError("a name of 1 to 40 characters is needed")
            check_pin(pin, Level.ADMIN)
            if not is_code(self._keys, code):
                shown = visible(name)
                append(self._folder, Kind.LOGIN_FAILED, shown, shown, reason=f"commissioning code, {source}")
                raise LoginError(WRONG_CODE)
            use_up(self._keys)
            reason = "commissioning code"
            user = self._save(name, level=Level.ADMIN, pin=pin, by=name, reason=reason)
            append(self._folder, Kind.LOGIN, name, name, reason=source)
            self._tries.succeeded(CODE)
            return user

    def log_out(self, user: User, why: str) -> None:
        """Note in the journal that a user has logged out, and why. Raises RecordError."""
        append(self._folder, Kind.LOGOUT, user.name, user.name, reason=why)


def _is_name(name: str) -> bool:
    return 1 <= len(name) <= MAX_NAME and name.isprintable()


def _another_admin(stored: dict[str, StoredUser], name: str) -> bool:
    return any(user.level is Level.ADMIN for other, user in stored.items() if other != name)


def _level_of(stored: dict[str, StoredUser], name: str) -> str:
    return stored[name].level.name.lower() if name in stored else ""

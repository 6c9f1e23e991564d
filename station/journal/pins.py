"""Stored forms of PINs: hashes with the key of the installation, worthless to who reads the journal alone."""

import hashlib
import hmac
import secrets
from pathlib import Path

from station.errors import LoginError
from station.files.private import read_private, write_private
from station.journal.users import Level, StoredUser

KEY = "pins.key"
"""Name of the key's file in the folder of the keys."""
KEY_BYTES = 32
MIN_DIGITS = {Level.OPERATOR: 4, Level.SETTER: 4, Level.QUALITY: 6, Level.ADMIN: 6}
"""Length of the shortest PIN by level."""
MAX_DIGITS = 12
"""Length of the longest PIN."""


def check_pin(pin: str, level: Level) -> None:
    """Raise LoginError unless a user of this level may have this PIN."""
    if not (pin.isascii() and pin.isdigit() and MIN_DIGITS[level] <= len(pin) <= MAX_DIGITS):
        if MIN_DIGITS[level] > min(MIN_DIGITS.values()):
            raise LoginError("a PIN of 6 to 12 digits is needed")
        raise LoginError("a PIN of 4 to 12 digits is needed")


def stored_pin(keys: Path, level: Level, pin: str) -> StoredUser:
    """Return what is stored of a user; the key is made with the first PIN. Raises LoginError."""
    salt = secrets.token_hex(16)
    return StoredUser(level, salt, _hash(pin, salt, _key(keys, make=True)), keyed=True)


def is_pin(keys: Path, stored: StoredUser | None, pin: str) -> bool:
    """Return whether this is the PIN of a user; an unknown user (None) takes as long. Raises LoginError."""
    if stored is None:
        _hash(pin, "00" * 16, b"")
        return False
    key = _key(keys) if stored.keyed else b""
    return hmac.compare_digest(_hash(pin, stored.salt, key), stored.hash)


def _key(keys: Path, *, make: bool = False) -> bytes:
    path = keys / KEY
    try:
        try:
            key = read_private(path)
        except FileNotFoundError:
            if not make:
                raise
            write_private(path, secrets.token_bytes(KEY_BYTES), replace=False)
            key = read_private(path)
    except OSError as error:
        raise LoginError(
            f"{path}: the key of the PINs cannot be used ({error.strerror}); restore the folder, or make a "
            "new administrator: weldgate commission"
        ) from None
    if len(key) != KEY_BYTES:
        raise LoginError(f"{path}: damaged; restore it, or make a new administrator: weldgate commission")
    return key


def _hash(pin: str, salt: str, key: bytes) -> str:
    secret = hmac.digest(key, pin.encode(), "sha256") if key else pin.encode()
    return hashlib.scrypt(secret, salt=bytes.fromhex(salt), n=2**14, r=8, p=1).hex()

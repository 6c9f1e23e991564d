"""The commissioning code: the only way to an administrator that no administrator has made.

Who may run a command under the account of the engine makes it; it is used up by the first who enters it.
"""

import hashlib
import hmac
import json
import secrets
from pathlib import Path

from station.errors import LoginError
from station.files.durable import sync_folder
from station.files.private import read_private, write_private

NAME = "commissioning.json"
"""Name of the file in the folder of the keys; it holds a salted hash of the code."""
DIGITS = 12
"""Length of a code."""


def make_code(keys: Path) -> str:
    """Make a code, which replaces the one before, and return it: "1234-5678-9012". Raises OSError."""
    digits = "".join(secrets.choice("0123456789") for _ in range(DIGITS))
    salt = secrets.token_hex(16)
    write_private(keys / NAME, json.dumps({"salt": salt, "hash": _hash(digits, salt)}).encode())
    return "-".join(digits[place : place + 4] for place in range(0, DIGITS, 4))


def is_code(keys: Path, code: str) -> bool:
    """Return whether this is the code that was made and is not used up. Raises LoginError."""
    path = keys / NAME
    try:
        stored = json.loads(read_private(path))
        salt, expected = str(stored["salt"]), str(stored["hash"])
        bytes.fromhex(salt)
    except FileNotFoundError:
        return False
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise LoginError(f"{path}: cannot be used ({error}); make a new code: weldgate commission") from None
    digits = "".join(character for character in code if character not in " -")
    return hmac.compare_digest(_hash(digits, salt), expected)


def use_up(keys: Path) -> None:
    """Delete the code: it was used. Raises LoginError if it cannot be deleted; then it must not be used."""
    try:
        (keys / NAME).unlink()
        sync_folder(keys)
    except OSError as error:
        raise LoginError(
            f"{keys / NAME}: cannot be deleted ({error.strerror}); nothing was changed"
        ) from None


def _hash(digits: str, salt: str) -> str:
    return hashlib.scrypt(digits.encode(), salt=bytes.fromhex(salt), n=2**14, r=8, p=1).hex()

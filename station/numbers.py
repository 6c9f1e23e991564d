"""Reads numbers that come in as text, alike in all fields and options; pure.

A decimal comma is a decimal point. Only plain ASCII digits count: no underscores, no infinity, no NaN.
"""

import re
from argparse import ArgumentTypeError
from collections.abc import Iterable
from typing import Annotated, Any

from pydantic import Field

Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
"""A finite number in a file or message; neither a text nor true or false."""

LAST_PORT = 65535
"""Highest TCP port."""

_DECIMAL = r"\d+(?:[.,]\d+)?"
_NUMBER = re.compile(rf"[+-]?{_DECIMAL}(?:[eE][+-]?\d{{1,3}})?", re.ASCII)
_WHOLE = re.compile(r"[+-]?\d{1,18}", re.ASCII)
_KEY = re.compile(r"[1-9]\d{0,17}", re.ASCII)
_ENTRY = re.compile(rf"\s*(\d{{1,2}})\s*:\s*({_DECIMAL})\s*(?:[;,]\s*|\Z)", re.ASCII)


def number(text: str) -> float:
    """Return the number that a text says. Raises ValueError."""
    if not _NUMBER.fullmatch(text.strip()) or (value := float(text.replace(",", "."))) in (
        float("inf"),
        float("-inf"),
    ):
        raise ValueError(f"{text!r} is not a number")
    return value


def whole(text: str) -> int:
    """Return the whole number that a text says. Raises ValueError."""
    if not _WHOLE.fullmatch(text.strip()):
        raise ValueError(f"{text!r} is not a whole number")
    return int(text)


def numbered(text: str) -> dict[int, float]:
    """Return numbers by number, as in `1: 0,6; 12: 0.3`; commas separate entries too.

    Raises ValueError if the text has another form or names a number twice.
    """
    found: dict[int, float] = {}
    rest = text.strip()
    while rest:
        entry = _ENTRY.match(rest)
        if entry is None:
            raise ValueError(f"{rest!r} is not a number with its value, such as 1: 0.6")
        key = int(entry[1])
        if key in found:
            raise ValueError(f"{key} is named twice")
        found[key] = number(entry[2])
        rest = rest[entry.end() :]
    return found


def number_option(text: str) -> float:
    """Return the number of an option of a command. Raises argparse.ArgumentTypeError."""
    try:
        return number(text)
    except ValueError as error:
        raise ArgumentTypeError(str(error)) from None


def whole_option(text: str) -> int:
    """Return the whole number of an option of a command. Raises argparse.ArgumentTypeError."""
    try:
        return whole(text)
    except ValueError as error:
        raise ArgumentTypeError(str(error)) from None


def port_option(text: str) -> int:
    """Return the TCP port of an option of a command. Raises argparse.ArgumentTypeError."""
    port = whole_option(text)
    if not 1 <= port <= LAST_PORT:
        raise ArgumentTypeError(f"{port} is not a TCP port; 1 to {LAST_PORT} is allowed")
    return port


def not_bool(value: object) -> object:
    """Return a value that is not true or false, which count as 1 and 0 otherwise. Raises ValueError."""
    if isinstance(value, bool):
        raise ValueError("should be a number")
    return value


def number_key(key: object) -> object:
    """Return the key of a table as a whole number if it is one in its only form: 2, but not 02 or +2.

    Raises ValueError for another text, so that no two keys mean one number.
    """
    if not isinstance(key, str):
        return key
    if not _KEY.fullmatch(key):
        raise ValueError(f"{key!r} is not a number in its usual form, such as 2")
    return int(key)


def without_twins(pairs: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return the members of a JSON object; for json.loads. Raises ValueError if a key is given twice."""
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"{key!r} is given twice")
        found[key] = value
    return found

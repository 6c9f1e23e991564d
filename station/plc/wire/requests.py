"""Checks the values of a Modbus request: Application Protocol V1.1b3, section 6; pure.

The order of the checks is that of the specification: function (01), quantity and value (03), address (02).
"""

import struct
from dataclasses import dataclass

ILLEGAL_FUNCTION, ILLEGAL_ADDRESS, ILLEGAL_VALUE, BUSY = 1, 2, 3, 6
"""Codes of exceptions."""
FUNCTIONS = frozenset((1, 2, 3, 4, 5, 6, 15, 16, 22, 23, 43))
"""Function codes that are served."""
CLIENT_WRITES = frozenset((5, 6, 15, 16, 22, 23))
"""Function codes by which a peer writes."""
BIT_WRITES = frozenset((5, 15))
"""Function codes that write bits; 16 of them make a register."""
MEANINGS = {
    ILLEGAL_FUNCTION: "illegal function",
    ILLEGAL_ADDRESS: "illegal data address",
    ILLEGAL_VALUE: "illegal data value",
}
"""Meaning of the exceptions for wrong requests, for the log."""
_READS = {1: (2000, 16), 2: (2000, 16), 3: (125, 1), 4: (125, 1)}
"""Largest quantity of each function that reads, and how many of its units make a register."""
_IDENTIFICATION, _DEVICE_CODES = 14, (1, 2, 3, 4)
_OBJECTS = (0, 1, 2, 4)
"""Objects of the device identification that exist."""


@dataclass(frozen=True, slots=True)
class Span:
    """Range of registers or bits that a request touches."""

    address: int
    count: int
    per_register: int
    """Number of units in a register: 1 or 16."""

    def ends_within(self, registers: int) -> bool:
        """Return whether it ends before the last of `registers`."""
        return self.address + self.count <= registers * self.per_register


def exception(body: bytes, registers: int) -> int | None:
    """Return the code with which a request must be refused; None if its values are in order.

    `body`: function code and data; `registers`: number of registers that exist.
    """
    function, data = body[0], body[1:]
    if function not in FUNCTIONS:
        return ILLEGAL_FUNCTION
    if function == 43:
        return _device(data)
    try:
        spans = _spans(function, data)
    except struct.error:  # too few bytes
        return ILLEGAL_VALUE
    if spans is None:
        return ILLEGAL_VALUE
    return None if all(span.ends_within(registers) for span in spans) else ILLEGAL_ADDRESS


def writes_within(window: range, function: int, address: int, count: int) -> bool:
    """Return whether a write touches only registers of the window; `count`: registers, also for bits."""
    first = address // 16 if function in BIT_WRITES else address
    return first in window and first + count - 1 in window


def _spans(function: int, data: bytes) -> list[Span] | None:
    """Return what a request touches, or None if a quantity, value or length is wrong. Raises struct.error."""
    address, count = struct.unpack_from(">HH", data)
    per_register = 16 if function in (1, 2, 5, 15) else 1
    if function in _READS:
        most, per_register = _READS[function]
        return _valid(len(data) == 4 and 1 <= count <= most, Span(address, count, per_register))
    if function == 5:
        return _valid(len(data) == 4 and count in (0x0000, 0xFF00), Span(address, 1, per_register))
    if function == 6:
        return _valid(len(data) == 4, Span(address, 1, per_register))
    if function == 22:
        return _valid(len(data) == 6, Span(address, 1, per_register))
    if function == 23:
        to, written, size = struct.unpack_from(">HHB", data, 4)
        fits = size == 2 * written == len(data) - 9
        good = fits and 1 <= count <= 125 and 1 <= written <= 121
        return _valid(good, Span(address, count, 1), Span(to, written, 1))
    (size,) = struct.unpack_from(">B", data, 4)
    most, needed = (1968, (count + 7) // 8) if function == 15 else (123, 2 * count)
    good = 1 <= count <= most and size == needed == len(data) - 5
    return _valid(good, Span(address, count, per_register))


def _valid(good: bool, *spans: Span) -> list[Span] | None:
    return list(spans) if good else None


def _device(data: bytes) -> int | None:
    if not data or data[0] != _IDENTIFICATION:
        return ILLEGAL_FUNCTION
    if len(data) != 3 or data[1] not in _DEVICE_CODES:
        return ILLEGAL_VALUE
    return ILLEGAL_ADDRESS if data[1] == 4 and data[2] not in _OBJECTS else None

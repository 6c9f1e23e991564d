"""Splits bytes into Modbus requests: messaging guide for TCP/IP, section 3.1.3 (MBAP header); pure."""

HEADER = 6
"""Bytes of transaction, protocol and length (two each); unit, function and data follow."""
MAX_LENGTH = 254
"""Largest value of the length field: unit, function and 252 bytes of data."""
FUNCTIONS = frozenset((1, 2, 3, 4, 5, 6, 15, 16, 22, 23, 43))
"""Function codes that are served."""
CLIENT_WRITES = frozenset((5, 6, 15, 16, 22, 23))
"""Function codes by which a peer writes."""
BIT_WRITES = frozenset((5, 15))
"""Function codes that address bits; 16 of them make a register."""


def frames(data: bytes) -> tuple[list[bytes], int, str | None]:
    """Return the whole requests at the start of `data`, their length in bytes, and what is wrong after them.

    The last is None if nothing is wrong, or too little has arrived to know.
    """
    found: list[bytes] = []
    used = 0
    while True:
        rest = data[used:]
        problem = _problem(rest)
        if problem is not None or len(rest) < HEADER:
            return found, used, problem
        end = HEADER + int.from_bytes(rest[4:6], "big")
        if len(rest) < end:
            return found, used, None
        found.append(rest[:end])
        used += end


def refusal(frame: bytes) -> bytes:
    """Return the response 01, illegal function, to a whole request that cannot be served."""
    return frame[:4] + bytes([0, 3, frame[6], frame[7] | 0x80, 1])


def writes_within(window: range, function: int, address: int, count: int) -> bool:
    """Return whether a write touches only registers of the window; `count`: registers, also for bits."""
    first = address // 16 if function in BIT_WRITES else address
    return first in window and first + count - 1 in window


def _problem(data: bytes) -> str | None:
    if len(data) >= 4 and data[2:4] != b"\0\0":
        return "does not speak Modbus"
    length = int.from_bytes(data[4:6], "big")
    if len(data) >= HEADER and not 2 <= length <= MAX_LENGTH:
        return f"sent a request of {length} bytes"
    return None

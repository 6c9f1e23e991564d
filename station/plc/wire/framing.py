"""Splits bytes into Modbus requests: messaging guide for TCP/IP, section 3.1.3 (MBAP header); pure."""

HEADER = 6
"""Bytes of transaction, protocol and length (two each); unit, function and data follow."""
MAX_LENGTH = 254
"""Largest value of the length field: unit, function and 252 bytes of data."""
NOT_MODBUS, WRONG_LENGTH = "does not speak Modbus", "sent a request of an impossible length"
"""What can be wrong with bytes: another protocol, or a length field that no request has."""


def frames(data: bytes, most: int) -> tuple[list[bytes], int, str | None]:
    """Return up to `most` whole requests at the start of `data`, their bytes, and what is wrong after them.

    The last is None if nothing is wrong, or too little has arrived to know.
    """
    found: list[bytes] = []
    used = 0
    while len(found) < most:
        rest = data[used : used + HEADER + MAX_LENGTH]
        problem = _problem(rest)
        if problem is not None or len(rest) < HEADER:
            return found, used, problem
        end = HEADER + int.from_bytes(rest[4:6], "big")
        if len(rest) < end:
            return found, used, None
        found.append(rest[:end])
        used += end
    return found, used, None


def refusal(frame: bytes, code: int) -> bytes:
    """Return the exception response to a whole request that is not carried out."""
    return frame[:4] + bytes([0, 3, frame[6], frame[7] | 0x80, code])


def _problem(data: bytes) -> str | None:
    if len(data) >= 4 and data[2:4] != b"\0\0":
        return NOT_MODBUS
    length = int.from_bytes(data[4:6], "big")
    if len(data) >= HEADER and not 2 <= length <= MAX_LENGTH:
        return WRONG_LENGTH
    return None

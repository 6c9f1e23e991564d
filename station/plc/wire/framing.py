"""Requests out of a stream of bytes, after the Modbus messaging guide for TCP/IP, section 3.1.3 (MBAP header); pure."""

HEADER = 6
"""Transaction, protocol and length, two bytes each; unit, function and data follow."""
MAX_LENGTH = 254
"""Of what follows the length field: unit, function, 252 bytes of data."""
FUNCTIONS = frozenset((1, 2, 3, 4, 5, 6, 15, 16, 22, 23, 43))
"""Function codes that are served."""
CLIENT_WRITES = frozenset((5, 6, 15, 16, 22, 23))
"""Function codes by which a peer writes."""


def frames(data: bytes) -> tuple[list[bytes], int, str | None]:
    """Whole requests at the beginning of `data`, how many bytes they take, and what is wrong with what follows, if that can be told."""
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
    """Exception 01, illegal function, in answer to a whole request that cannot be served."""
    return frame[:4] + bytes([0, 3, frame[6], frame[7] | 0x80, 1])


def _problem(data: bytes) -> str | None:
    if len(data) >= 4 and data[2:4] != b"\0\0":
        return "does not speak Modbus"
    length = int.from_bytes(data[4:6], "big")
    if len(data) >= HEADER and not 2 <= length <= MAX_LENGTH:
        return f"sent a request of {length} bytes"
    return None

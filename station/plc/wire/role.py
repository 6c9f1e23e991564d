"""Reads the role in a certificate (Modbus/TCP Security, 8.4); pure.

Python's ssl shows no extensions that it does not know, so the certificate's DER is walked to this one.
"""

from collections.abc import Iterator

ROLE_OID = "1.3.6.1.4.1.50316.802.1"
"""Object identifier of the role extension."""
_SEQUENCE, _OBJECT, _OCTETS, _UTF8, _EXTENSIONS = 0x30, 0x06, 0x04, 0x0C, 0xA3


def role_of(certificate: bytes) -> str | None:
    """Return the role in a certificate (DER); None if it has none, or none that can be read."""
    try:
        return _role(certificate)
    except (IndexError, UnicodeDecodeError):
        return None


def _role(certificate: bytes) -> str | None:
    signed = _only(_only(certificate, _SEQUENCE), _SEQUENCE)
    for extension in _values(_only(_only(signed, _EXTENSIONS), _SEQUENCE), _SEQUENCE):
        if _only(extension, _OBJECT) == _encoded(ROLE_OID):
            return _only(_only(extension, _OCTETS), _UTF8).decode()
    return None


def _only(data: bytes, tag: int) -> bytes:
    """Return the contents of the first value with a tag. Raises IndexError if there is none."""
    for value in _values(data, tag):
        return value
    raise IndexError(f"no value with the tag {tag}")


def _values(data: bytes, tag: int) -> Iterator[bytes]:
    at = 0
    while at < len(data):
        found, length, start = data[at], data[at + 1], at + 2
        if length & 0x80:
            count = length & 0x7F
            length, start = int.from_bytes(data[start : start + count], "big"), start + count
        if start + length > len(data):
            raise IndexError("a value ends after the data")
        if found == tag:
            yield data[start : start + length]
        at = start + length


def _encoded(identifier: str) -> bytes:
    numbers = [int(part) for part in identifier.split(".")]
    encoded = bytes([40 * numbers[0] + numbers[1]])
    for number in numbers[2:]:
        sevens = [number & 0x7F]
        while number := number >> 7:
            sevens.append(0x80 | number & 0x7F)
        encoded += bytes(reversed(sevens))
    return encoded

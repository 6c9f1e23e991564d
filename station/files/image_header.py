"""Reads the head of an image file before it is decoded: its size, and what would be seen otherwise.

One rule for all formats: one picture, upright, black is 0. What a decoder would drop or turn is refused.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

MAX_SIDE_PX = 32_000
"""Maximum width and height of an image."""
MAX_DECODED_BYTES = 1 << 30
"""Maximum size of the decoded pixels."""
MAX_TAGS = 4096
"""Number of tags or blocks that are looked at."""
_TYPES = {1: "B", 3: "H", 4: "I", 16: "Q"}
"""Numbers of a TIFF tag: BYTE, SHORT, LONG, LONG8."""
_WIDTH, _HEIGHT, _BITS, _PHOTOMETRIC, _FILL_ORDER, _ORIENTATION = 256, 257, 258, 262, 266, 274
_SAMPLES, _SAMPLE_FORMAT = 277, 339
_UPRIGHT = {
    _FILL_ORDER: "the order of its bits",
    _ORIENTATION: "the orientation",
    _SAMPLE_FORMAT: "the sample format",
}
"""TIFF tags that must be 1."""


@dataclass(frozen=True, slots=True)
class Header:
    """What the head of an image file says."""

    width_px: int
    height_px: int
    bytes_per_px: int = 4
    pictures: int = 1
    odd: tuple[str, ...] = field(default=(), kw_only=True)
    """What would be seen otherwise than it is meant."""

    def problem(self) -> str | None:
        """Return why the image is not decoded, or None."""
        size = f"{self.width_px} x {self.height_px} px"
        if max(self.width_px, self.height_px) > MAX_SIDE_PX:
            return f"{size} is too large; the maximum is {MAX_SIDE_PX} px per side"
        if self.width_px * self.height_px * self.bytes_per_px > MAX_DECODED_BYTES:
            return f"{size} is too large; the maximum is {MAX_DECODED_BYTES >> 20} MiB decoded"
        if self.pictures > 1:
            return f"holds {self.pictures} pictures; write each to a file of its own"
        if self.odd:
            return f"{'; '.join(self.odd)}; write it as plain grey, upright, black as 0"
        return None


def read_header(data: bytes) -> Header | None:
    """Return the head of a PNG, TIFF, BMP or JPEG file, or None if it cannot be read."""
    try:
        if data[:8] == b"\x89PNG\r\n\x1a\n":
            return _png(data)
        if data[:4] in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
            return _tiff(data)
        if data[:2] == b"BM":
            old = struct.unpack_from("<I", data, 14)[0] == 12
            width, height = struct.unpack_from("<HH" if old else "<ii", data, 18)
            return Header(abs(width), abs(height))
        if data[:2] == b"\xff\xd8":
            return _jpeg(data)
    except (struct.error, IndexError, ValueError, OverflowError):
        return None
    return None


def _png(data: bytes) -> Header:
    width, height, depth, colour = struct.unpack_from(">IIBB", data, 16)
    samples = {0: 1, 2: 3, 3: 3, 4: 2, 6: 4}.get(colour, 4)
    pictures, odd, place = 1, [], 8
    for _ in range(MAX_TAGS):
        if place + 8 > len(data):
            break
        length, kind = struct.unpack_from(">I4s", data, place)
        if kind == b"acTL":
            pictures = struct.unpack_from(">I", data, place + 8)[0]
        elif kind == b"eXIf":
            odd += _turned(data[place + 8 : place + 8 + length])
        elif kind in (b"IDAT", b"IEND"):
            break
        place += 12 + length
    return Header(width, height, samples * (2 if depth == 16 else 1), pictures, odd=tuple(odd))


def _jpeg(data: bytes) -> Header | None:
    place, odd = 2, []
    for _ in range(MAX_TAGS):
        if data[place] != 0xFF:
            return None
        marker = data[place + 1]
        (length,) = struct.unpack_from(">H", data, place + 2)
        if marker == 0xE1 and data[place + 4 : place + 10] == b"Exif\0\0":
            odd += _turned(data[place + 10 : place + 2 + length])
        if 0xC0 <= marker <= 0xCF and marker not in (0xC4, 0xC8, 0xCC):
            height, width, samples = struct.unpack_from(">HHB", data, place + 5)
            return Header(width, height, samples, odd=tuple(odd))
        place += 2 + length
    return None


def _turned(exif: bytes) -> list[str]:
    try:
        tags = next(iter(_pages(exif)), {})
    except (struct.error, IndexError, OverflowError):
        return []
    return [f"the orientation is {tags[_ORIENTATION]}, not 1"] if tags.get(_ORIENTATION, 1) != 1 else []


def _tiff(data: bytes) -> Header | None:
    pages = list(_pages(data))
    if not pages:
        return None
    tags = pages[0]
    odd = [f"{name} is {tags[tag]}, not 1" for tag, name in _UPRIGHT.items() if tags.get(tag, 1) != 1]
    photometric = tags.get(_PHOTOMETRIC, 1)
    if photometric not in (1, 2):
        names = {0: "white is 0", 3: "its values are numbers of a palette"}
        odd.append(
            names.get(photometric, f"its values are of kind {photometric} (PhotometricInterpretation)")
        )
    if tags.get(_BITS, 1) not in (8, 16):
        odd.append(f"it has {tags.get(_BITS, 1)} bits per value, not 8 or 16")
    bytes_per_px = tags.get(_SAMPLES, 1) * (2 if tags.get(_BITS, 1) > 8 else 1)
    return Header(tags.get(_WIDTH, 0), tags.get(_HEIGHT, 0), bytes_per_px, len(pages), odd=tuple(odd))


def _pages(data: bytes) -> Iterator[dict[int, int]]:
    """Yield the first number of each tag of a TIFF file's first picture, and {} for each further picture."""
    order = "<" if data[:2] == b"II" else ">"
    big = data[2:4] in (b"+\0", b"\0+")
    counter, pointer, entry = ("Q", "Q", 20) if big else ("H", "I", 12)
    (place,) = struct.unpack_from(order + pointer, data, 8 if big else 4)
    seen: set[int] = set()
    while place and place not in seen and len(seen) < MAX_TAGS:
        seen.add(place)
        (count,) = struct.unpack_from(order + counter, data, place)
        first = place + struct.calcsize(order + counter)
        own = _tags(data, order=order, first=first, count=min(count, MAX_TAGS), entry=entry)
        yield dict(own) if len(seen) == 1 else {}
        (place,) = struct.unpack_from(order + pointer, data, first + count * entry)


def _tags(data: bytes, *, order: str, first: int, count: int, entry: int) -> Iterator[tuple[int, int]]:
    for at in range(first, first + count * entry, entry):
        tag, kind = struct.unpack_from(order + "HH", data, at)
        (number,) = struct.unpack_from(order + ("Q" if entry == 20 else "I"), data, at + 4)
        form, value_at, room = _TYPES.get(kind), at + (12 if entry == 20 else 8), 8 if entry == 20 else 4
        if form is None or not number:
            continue
        if number * struct.calcsize(form) > room:
            (value_at,) = struct.unpack_from(order + ("Q" if entry == 20 else "I"), data, value_at)
        yield tag, struct.unpack_from(order + form, data, value_at)[0]

"""Files that are whole or absent: written under another name, then renamed."""

import json
from pathlib import Path

import cv2
from numpy.typing import NDArray

from station.files.durable import write_whole
from synth.errors import SynthError


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file. Raises SynthError with the reason if it cannot be written."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, content)
    except OSError as error:
        raise SynthError(f"{path}: could not be written: {error.strerror or error}") from None


def write_text(path: Path, text: str) -> None:
    """Write a text file, UTF-8."""
    write_bytes(path, text.encode())


def write_image(path: Path, image: NDArray) -> None:  # type: ignore[type-arg]
    """Write an image in the format of the path's suffix."""
    write_bytes(path, encode(path.suffix or ".png", image))


def encode(suffix: str, image: NDArray) -> bytes:  # type: ignore[type-arg]
    """Return the bytes of an image file."""
    good, content = cv2.imencode(suffix, image, [cv2.IMWRITE_PNG_COMPRESSION, 3] if suffix == ".png" else [])
    if not good:
        raise SynthError(f"an image of shape {image.shape} could not be encoded as {suffix}")
    return bytes(content)


def claim(path: Path, manifest: dict[str, object]) -> None:
    """Write what a folder is to hold, or check that it holds the same. Raises SynthError if it does not."""
    expected = json.loads(json.dumps(manifest))
    if not path.exists():
        write_text(path, json.dumps(expected, indent=1))
        return
    try:
        held = json.loads(path.read_text())
    except (OSError, ValueError):
        raise SynthError(f"{path}: not readable; name an empty folder with --out") from None
    differing = sorted(key for key in expected if held.get(key) != expected[key])
    if differing:
        names = ", ".join(differing)
        raise SynthError(f"{path.parent}: was begun with another {names}; name an empty folder with --out")

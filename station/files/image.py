"""Reads image files as grey images, and encodes frames without loss."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import Image
from station.errors import ImageError
from station.files.image_header import read_header
from station.files.regular import read_regular

SUFFIXES = frozenset((".png", ".bmp", ".tif", ".tiff", ".jpg", ".jpeg"))
"""Suffixes of image files that can be read, in lower case."""
MAX_BYTES = 512 * 1024 * 1024
"""Maximum size of an image file."""
PNG = (
    *(cv2.IMWRITE_PNG_COMPRESSION, 1),
    *(cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_AVG),
    *(cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_RLE),
)
"""Options of the PNG encoder, chosen by measurement (`deploy.bench.records`)."""


def read_image(path: Path) -> Image:
    """Return the image in a file as grey values (height, width) uint8.

    Of 16-bit values the upper 8 bits are used; colour is converted to grey. Raises ImageError with the file
    and what is wrong with it.
    """
    return read_marked(path)[0]


def read_marked(path: Path) -> tuple[Image, tuple[str, ...]]:
    """Return an image like `read_image`, and a warning for each kind of loss. Raises ImageError."""
    warnings = []
    if path.suffix.lower() in (".jpg", ".jpeg"):
        warnings.append("JPEG: the compression changes scores; record images without loss")
    try:
        if path.stat().st_size > MAX_BYTES:
            raise ImageError(f"{path}: larger than 512 MiB, so it is not a frame")
        content = read_regular(path, MAX_BYTES)
    except (OSError, ValueError) as error:
        raise ImageError(f"{path}: cannot be read ({getattr(error, 'strerror', error)})") from None
    image, header = None, read_header(content)
    if header is not None and (problem := header.problem()) is not None:
        raise ImageError(f"{path}: {problem}")
    if header is not None:
        try:
            image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
        except cv2.error:
            image = None
    if image is None:
        raise ImageError(f"{path}: not a readable image; use PNG, BMP, TIFF or JPEG")
    if image.dtype not in (np.uint8, np.uint16):
        raise ImageError(f"{path}: pixels are {image.dtype}; use 8 or 16 bits per pixel")
    if image.ndim == 3 and image.shape[2] >= 3 and not _grey(image):
        warnings.append("colour: only the brightness is judged")
    if image.ndim == 3:
        image = (
            image[:, :, 0]
            if image.shape[2] < 3
            else cv2.cvtColor(np.ascontiguousarray(image[:, :, :3]), cv2.COLOR_BGR2GRAY)
        )
    if image.dtype == np.uint16 and (highest := int(image.max(initial=0))) < 1 << 14:
        bits = max(8, highest.bit_length())
        warnings.append(
            f"only {bits} of 16 bits are used (highest value {highest} of 65535), but the upper 8 bits are "
            f"judged; multiply the values by {1 << (16 - bits)}"
        )
    if image.dtype == np.uint16:
        image = np.asarray(image // 256, np.uint8)
    return np.ascontiguousarray(image), tuple(warnings)


def _grey(image: NDArray[Any]) -> bool:
    return bool((image[..., 0] == image[..., 1]).all() and (image[..., 1] == image[..., 2]).all())


def encode_png(image: Image) -> bytes:
    """Return an image as PNG, without loss. Raises ImageError."""
    try:
        done, buffer = cv2.imencode(".png", image, PNG)
    except cv2.error as error:
        raise ImageError(f"the frame could not be encoded: {error.err}") from None
    if not done:
        raise ImageError("the frame could not be encoded")
    return bytes(buffer)

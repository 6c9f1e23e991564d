"""Image files to grey pictures and back, lossless."""

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import Image
from station.errors import ImageError

SUFFIXES = frozenset((".png", ".bmp", ".tif", ".tiff", ".jpg", ".jpeg"))
MAX_BYTES = 512 * 1024 * 1024
MAX_SIDE_PX = 32_000
PNG = (
    *(cv2.IMWRITE_PNG_COMPRESSION, 1),
    *(cv2.IMWRITE_PNG_FILTER, cv2.IMWRITE_PNG_FILTER_AVG),
    *(cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_RLE),
)


def read_image(path: Path) -> Image:
    """Picture (H, W) uint8. 16-bit pictures keep their upper 8 bits, colour becomes grey.

    Raises ImageError naming the file and what is wrong with it.
    """
    return read_marked(path)[0]


def read_marked(path: Path) -> tuple[Image, tuple[str, ...]]:
    """The same, and what was lost before: compression, colour, depth. Raises ImageError."""
    warnings = []
    if path.suffix.lower() in (".jpg", ".jpeg"):
        warnings.append("JPEG: its compression changes scores; record lossless")
    try:
        if path.stat().st_size > MAX_BYTES:
            raise ImageError(f"{path}: larger than 512 MiB; not a frame")
        raw = np.frombuffer(path.read_bytes(), np.uint8)
    except OSError as error:
        raise ImageError(f"{path}: cannot be read ({error.strerror})") from None
    image = None
    if raw.size:
        try:
            image = cv2.imdecode(raw, cv2.IMREAD_UNCHANGED)
        except cv2.error:
            image = None
    if image is None:
        raise ImageError(f"{path}: not a readable image; PNG, BMP, TIFF or JPEG is needed")
    if image.dtype not in (np.uint8, np.uint16):
        raise ImageError(f"{path}: pixels are {image.dtype}; 8 or 16 bit is needed")
    if max(image.shape[:2]) > MAX_SIDE_PX:
        raise ImageError(f"{path}: {image.shape[1]} x {image.shape[0]} px; at most {MAX_SIDE_PX} px a side")
    if image.ndim == 3 and image.shape[2] >= 3 and not _grey(image):
        warnings.append("colour: only its brightness is judged")
    if image.ndim == 3:
        image = (
            image[:, :, 0]
            if image.shape[2] < 3
            else cv2.cvtColor(np.ascontiguousarray(image[:, :, :3]), cv2.COLOR_BGR2GRAY)
        )
    if image.dtype == np.uint16:
        image = np.asarray(image // 256, np.uint8)
    return np.ascontiguousarray(image), tuple(warnings)


def _grey(image: NDArray[Any]) -> bool:
    return bool((image[..., 0] == image[..., 1]).all() and (image[..., 1] == image[..., 2]).all())


def encode_png(image: Image) -> bytes:
    """Lossless PNG. Filter and strategy by measurement (`deploy.bench.records`): a camera's noise has no repeats to look for."""
    try:
        done, buffer = cv2.imencode(".png", image, PNG)
    except cv2.error as error:
        raise ImageError(f"the frame could not be encoded: {error.err}") from None
    if not done:
        raise ImageError("the frame could not be encoded")
    return bytes(buffer)

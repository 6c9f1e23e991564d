"""Image of an unwrapped weld for a report, with its findings marked."""

import base64
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from station.domain import STRIP_COLUMNS, Ring
from station.errors import ImageError, LocateError
from station.files.image import read_image
from station.vision.unwrap import unwrap

MARK_BGR = (43, 57, 192)
"""Colour of the marks."""


@dataclass(frozen=True, slots=True)
class StripImage:
    """Image of a strip, or the reason why there is none."""

    jpeg_base64: str = ""
    missing: str = ""


@dataclass(frozen=True, slots=True)
class Weld:
    """One weld in a gallery: name, description and strip."""

    name: str
    text: str
    strip: StripImage


@dataclass(frozen=True, slots=True)
class Gallery:
    """Welds under one title."""

    title: str
    welds: tuple[Weld, ...]


def strip(
    path: Path | None, ring: Ring | None, spans_deg: Iterable[tuple[float, float]], *, um_per_px: float
) -> StripImage:
    """Return the unwrapped weld with marks at `spans_deg`, pairs of start and end; they may exceed 360.

    `um_per_px` is the scale of the image.
    """
    if path is None or ring is None:
        return StripImage(missing="no image")
    try:
        unwrapped = unwrap(read_image(path), ring, um_per_px=um_per_px)
        image = cv2.cvtColor(unwrapped, cv2.COLOR_GRAY2BGR)
    except (ImageError, LocateError):
        return StripImage(missing="the image was deleted or cannot be read")
    for start, end in spans_deg:
        left, right = (round(angle / 360 * STRIP_COLUMNS) for angle in (start, end))
        for turn in (0, STRIP_COLUMNS):
            cv2.rectangle(image, (left + 2 - turn, 2), (right - 3 - turn, image.shape[0] - 3), MARK_BGR, 4)
    done, jpeg = cv2.imencode(".jpg", np.asarray(image), [cv2.IMWRITE_JPEG_QUALITY, 80])
    if not done:
        return StripImage(missing="the image cannot be shown")
    return StripImage(base64.b64encode(bytes(jpeg)).decode())

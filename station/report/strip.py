"""A weld unwrapped, with what was found framed, as an image in a page."""

import base64
from collections.abc import Iterable
from pathlib import Path

import cv2
import numpy as np

from station.domain import STRIP_COLUMNS, Ring
from station.errors import ImageError, LocateError
from station.imagefile import read_image
from station.vision.unwrap import unwrap

MARK_BGR = (43, 57, 192)


def strip(picture: Path | None, ring: Ring | None, spans_deg: Iterable[tuple[float, float]]) -> str:
    """HTML of the strip; `spans_deg`: start and end of what is framed, ends may lie beyond 360."""
    if picture is None or ring is None:
        return "<p>no picture</p>"
    try:
        image = cv2.cvtColor(unwrap(read_image(picture), ring), cv2.COLOR_GRAY2BGR)
    except (ImageError, LocateError):
        return "<p>its picture is no longer kept, or cannot be read</p>"
    for start, end in spans_deg:
        left, right = (round(angle / 360 * STRIP_COLUMNS) for angle in (start, end))
        for turn in (0, STRIP_COLUMNS):
            cv2.rectangle(image, (left + 2 - turn, 2), (right - 3 - turn, image.shape[0] - 3), MARK_BGR, 4)
    done, jpeg = cv2.imencode(".jpg", np.asarray(image), [cv2.IMWRITE_JPEG_QUALITY, 80])
    return f'<img alt="unwrapped weld" src="data:image/jpeg;base64,{base64.b64encode(bytes(jpeg)).decode()}">' if done else ""

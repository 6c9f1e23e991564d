"""The small images for the window show the same of the part at any scale."""

import cv2
import numpy as np
import pytest

from station.channel.preview import make_preview
from station.domain import Image, Ring
from tests.parts import label_with


def decoded(jpeg: bytes) -> Image:
    return np.asarray(cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_GRAYSCALE), np.uint8)


@pytest.mark.parametrize("um_per_px", [9.0, 26.0])
def test_a_preview_shows_the_same_of_the_part_at_another_scale(
    um_per_px: float, frames: dict[str, Image]
) -> None:
    item, factor = label_with("hole"), 13.0 / um_per_px
    frame = frames[item["frame"]]
    x, y = item["center"]
    ours = make_preview(1, frame, Ring(x, y, item["radius"], 1.0), um_per_px=13.0)
    method = cv2.INTER_AREA if factor < 1 else cv2.INTER_CUBIC
    other = np.asarray(cv2.resize(frame, None, fx=factor, fy=factor, interpolation=method), np.uint8)
    ring = Ring((x + 0.5) * factor - 0.5, (y + 0.5) * factor - 0.5, item["radius"] * factor, 1.0)
    seen = make_preview(1, other, ring, um_per_px=um_per_px)
    shown = [
        np.array(decoded(one.frame_jpeg).shape) / one.scale * scale
        for one, scale in ((ours, 13.0), (seen, um_per_px))
    ]
    assert shown[0] == pytest.approx(shown[1], rel=0.01), "µm of the part"
    strips = [decoded(one.strip_jpeg).astype(float) for one in (ours, seen)]
    assert np.abs(strips[0] - strips[1]).mean() < 0.2 * strips[0].std()

import cv2
import numpy as np
import pytest

from station.domain import Image
from station.errors import LocateError
from station.inspection.inspector import Inspector
from tests.parts import label_with, labels


def test_ring_of_each_shipped_frame_is_found_to_a_twentieth_of_a_millimetre(
    frames: dict[str, Image], inspector: Inspector
) -> None:
    for item in labels():
        ring = inspector.locate(frames[item["frame"]])
        away_px = np.hypot(ring.center_x_px - item["center"][0], ring.center_y_px - item["center"][1])
        assert away_px * 0.013 < 0.05, item["frame"]
        assert abs(ring.radius_px - item["radius"]) * 0.013 < 0.05, item["frame"]


@pytest.mark.parametrize("name", ["black", "white", "noise", "grey noise", "stripes", "gradient"])
def test_nothing_is_not_a_weld(name: str, rng: np.random.Generator, inspector: Inspector) -> None:
    shape = (2160, 4200)
    image = {
        "black": lambda: np.zeros(shape),
        "white": lambda: np.full(shape, 255.0),
        "noise": lambda: rng.integers(0, 256, shape).astype(float),
        "grey noise": lambda: rng.normal(100, 4, shape),
        "stripes": lambda: np.broadcast_to(rng.normal(110, 25, shape[1]), shape),
        "gradient": lambda: np.broadcast_to(np.linspace(0, 255, shape[1]), shape),
    }[name]()
    with pytest.raises(LocateError):
        inspector.locate(np.asarray(np.clip(image, 0, 255), np.uint8))


@pytest.mark.parametrize("side", ["left", "right", "top", "bottom"])
def test_half_a_weld_in_view_is_never_a_ring(
    side: str, frames: dict[str, Image], inspector: Inspector
) -> None:
    item = label_with("OK")
    image, (x, y) = frames[item["frame"]], (round(v) for v in item["center"])
    half = {"left": image[:, :x], "right": image[:, x:], "top": image[:y], "bottom": image[y:]}[side]
    with pytest.raises(LocateError):
        inspector.locate(np.ascontiguousarray(half))


def test_a_hidden_half_is_never_a_ring(frames: dict[str, Image], inspector: Inspector) -> None:
    item = label_with("OK")
    image = frames[item["frame"]].copy()
    image[:, : round(item["center"][0])] = 90
    with pytest.raises(LocateError, match="no weld found"):
        inspector.locate(image)


@pytest.mark.parametrize("radius_px", [150, 300, 380, 480, 600])
def test_other_circles_are_not_taken_for_the_weld(
    radius_px: int, rng: np.random.Generator, inspector: Inspector
) -> None:
    image = np.asarray(np.clip(rng.normal(110, 3, (2160, 4200)), 0, 255), np.uint8)
    cv2.circle(image, (2100, 1080), radius_px, 20, 14, cv2.LINE_AA)
    with pytest.raises(LocateError, match="no weld found"):
        inspector.locate(image)


def test_other_circles_do_not_draw_the_ring_away(frames: dict[str, Image], inspector: Inspector) -> None:
    item = label_with("OK")
    image = frames[item["frame"]].copy()
    for radius_px in (120, 250, 600):
        cv2.circle(
            image,
            (round(item["center"][0]) + 15, round(item["center"][1]) - 12),
            radius_px,
            15,
            12,
            cv2.LINE_AA,
        )
    ring = inspector.locate(image)
    assert np.hypot(ring.center_x_px - item["center"][0], ring.center_y_px - item["center"][1]) < 2.0


def test_an_image_too_small_for_the_ring_is_refused(inspector: Inspector) -> None:
    with pytest.raises(LocateError, match="too small for a radius"):
        inspector.locate(np.zeros((480, 640), np.uint8))

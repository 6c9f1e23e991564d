"""Things that come between camera and weld, drawn into frames: a finger, dust, a shadow.

They share no code with the covers that the networks are trained with. A cover takes the whole frame and where
it lies, and returns the frame that the camera would see.
"""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Image = NDArray[np.uint8]
Weight = NDArray[np.float32]
"""Where a cover lies, (H, W) float32, 0 to 1."""
Cover = Callable[[np.random.Generator, Image, Weight], Image]


@dataclass(frozen=True, slots=True, kw_only=True)
class Area:
    """A piece of a ring, px and degrees, or what lies beside the ring."""

    center_x_px: float
    center_y_px: float
    radius_px: float
    start_deg: float
    end_deg: float
    half_width_px: float

    def weight(self, shape: tuple[int, int], *, soft_px: float = 2.0) -> Weight:
        """Return where the area lies in a frame of this shape."""
        rows, columns = np.indices(shape, np.float32)
        dx, dy = columns - self.center_x_px, rows - self.center_y_px
        away = self.half_width_px - np.abs(np.hypot(dx, dy) - self.radius_px)
        middle, half = (self.start_deg + self.end_deg) / 2, (self.end_deg - self.start_deg) / 2
        off = np.abs((np.rad2deg(np.arctan2(dy, dx)) - middle + 180) % 360 - 180)
        along = np.deg2rad(half - off) * self.radius_px
        inside = np.minimum(away, along) if half < 180 else away
        return np.asarray(np.clip(0.5 + inside / (2 * soft_px), 0, 1), np.float32)


def _mixed(frame: Image, weight: Weight, other: NDArray[np.floating]) -> Image:
    mixed = frame + weight * (other.astype(np.float32) - frame)
    return np.clip(np.round(mixed), 0, 255).astype(np.uint8)


def black(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with black tape over the area."""
    return _mixed(frame, weight, np.abs(rng.normal(1.0, 1.0, frame.shape)))


def grey(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with paper of one grey level over the area."""
    return _mixed(frame, weight, rng.uniform(30, 220) + rng.normal(0, 1.5, frame.shape))


def white(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with a saturated area."""
    return _mixed(frame, weight, np.full(frame.shape, 255.0))


def own_sheet(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with a piece of its own sheet over the area, moved there from the side."""
    rows, columns = np.nonzero(weight > 0)
    height, width = frame.shape
    far = np.hypot(rows - rows.mean(), columns - columns.mean()).max() if rows.size else 0
    shift = int(min(max(2.2 * far, 150), min(height, width) / 2 - 2))
    angle = rng.uniform(0, 2 * np.pi)
    moved = np.array([[1, 0, shift * np.cos(angle)], [0, 1, shift * np.sin(angle)]], np.float32)
    other = cv2.warpAffine(frame, moved, (width, height), borderMode=cv2.BORDER_REFLECT)
    return _mixed(frame, weight, np.asarray(other, np.float32))


def finger(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with a fingertip over the area: skin lit from one side, with ridges, out of focus."""
    rows, columns = np.indices(frame.shape, np.float32)
    angle, pitch = rng.uniform(0, np.pi), rng.uniform(25, 40)
    across = columns * np.cos(angle) + rows * np.sin(angle)
    curve = 14 * np.sin(rows / 160) + 10 * np.sin(columns / 130)
    skin = (
        rng.uniform(70, 170)
        + 35 * np.sin(across / rng.uniform(120, 300))
        + 9 * np.sin(2 * np.pi * (across + curve) / pitch)
    )
    return _mixed(frame, weight, skin + rng.normal(0, 2, frame.shape))


def blur(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with the area far out of focus."""
    soft = cv2.GaussianBlur(frame, (0, 0), rng.uniform(7, 15)) + rng.normal(0, 1.5, frame.shape)
    return _mixed(frame, weight, soft)


def motion(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with the area smeared by a movement."""
    length, angle = int(rng.uniform(35, 70)), rng.uniform(0, 180)
    kernel = np.zeros((length, length), np.float32)
    kernel[length // 2] = 1
    turn = cv2.getRotationMatrix2D(((length - 1) / 2, (length - 1) / 2), angle, 1.0)
    kernel = np.asarray(cv2.warpAffine(kernel, turn, (length, length)), np.float32)
    return _mixed(
        frame, weight, cv2.filter2D(frame, -1, kernel / kernel.sum()) + rng.normal(0, 1.5, frame.shape)
    )


def shadow(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with the area in a deep shadow."""
    return _mixed(frame, weight, frame * rng.uniform(0.01, 0.08) + rng.normal(0, 1.2, frame.shape))


def glare(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with a reflection over the area."""
    return _mixed(frame, weight, frame * 0.5 + rng.uniform(220, 330))


def dust(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with a film of dust over the area: little of the weld is seen behind it."""
    grains = cv2.GaussianBlur(rng.normal(0, 1, frame.shape).astype(np.float32), (0, 0), rng.uniform(1.0, 2.5))
    film = rng.uniform(90, 190) + grains / grains.std() * rng.uniform(6, 16)
    clear = rng.uniform(0.0, 0.12)
    return _mixed(frame, weight, film * (1 - clear) + frame * clear)


def drop(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with drops of water over the area: each shows what is behind it upside down."""
    rows, columns = (np.asarray(axis) for axis in np.indices(frame.shape, np.float32))
    covered_rows, covered_columns = np.nonzero(weight > 0.5)
    at_x, at_y = columns.copy(), rows.copy()
    if covered_rows.size:
        for index in rng.integers(0, covered_rows.size, 40):
            y, x, size = covered_rows[index], covered_columns[index], rng.uniform(35, 80)
            rho = np.hypot(columns - x, rows - y) / size
            inside = rho < 1
            at_x[inside] = x - (columns[inside] - x) * 2.2
            at_y[inside] = y - (rows[inside] - y) * 2.2
    bent = cv2.remap(frame, at_x, at_y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REFLECT)
    return _mixed(frame, weight, cv2.GaussianBlur(bent, (0, 0), 2.0).astype(np.float32) * 0.85)


def half_light(rng: np.random.Generator, frame: Image, weight: Weight) -> Image:
    """Return the frame with half of the lamp gone: little light is left on the side of the area."""
    rows, columns = np.indices(frame.shape, np.float32)
    y, x = (float(np.average(axis, weights=weight + 1e-9)) for axis in (rows, columns))
    height, width = frame.shape
    dx, dy = x - width / 2, y - height / 2
    along = ((columns - width / 2) * dx + (rows - height / 2) * dy) / max(np.hypot(dx, dy), 1.0)
    lost = np.clip(0.5 + along / 120, 0, 1)
    return _mixed(
        frame, lost.astype(np.float32), frame * rng.uniform(0.02, 0.06) + rng.normal(0, 1.2, frame.shape)
    )


COVERS: dict[str, Cover] = {
    "black": black,
    "grey": grey,
    "white": white,
    "own sheet": own_sheet,
    "finger": finger,
    "blur": blur,
    "motion": motion,
    "shadow": shadow,
    "glare": glare,
    "dust": dust,
    "drop": drop,
    "half light": half_light,
}
"""Covers by name."""

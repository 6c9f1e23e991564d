"""Rendered parts as camera images: whole frames, windows, the band round the weld, and straight pieces.

The renderer is loaded with the first image that is rendered: planning and reading need none.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENT_PX, STRIP_ROWS
from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.camera.scene import Pixels, join_pixels, part_scene, piece_scene, window_pixels
from synth.camera.sensor import expose
from synth.measured.spectrum import WeldModel
from synth.part.part import Part

Image = NDArray[np.uint8]
Map = NDArray[np.float32]
Window = tuple[int, int, int, int]
"""x, y, width, height in pixels of the whole frame."""

RING_WINDOW_PX = 1120
"""Side of the window that holds the ring with its strip."""
BAND_PX = STRIP_ROWS / 2 + 16
"""Half the width of the band that crops can show, with room for a moved ring and the blur."""
CROP_PX = SEGMENT_PX
"""Side of a crop."""
MARGIN_PX = 8
"""Rendered round a straight piece's crop for the blur."""


def ring_window(part: Part, optics: Optics) -> Window:
    """Return the window round the ring, inside the frame."""
    x, y, _ = ring_px(part, optics)
    half = RING_WINDOW_PX // 2
    left = int(np.clip(round(x) - half, 0, optics.width_px - RING_WINDOW_PX))
    top = int(np.clip(round(y) - half, 0, optics.height_px - RING_WINDOW_PX))
    return left, top, RING_WINDOW_PX, RING_WINDOW_PX


def frame_window(part: Part, model: WeldModel, optics: Optics, window: Window | None = None) -> Image:
    """Render a window (H, W) uint8 of the frame, by default all of it.

    Away from the weld one ray a pixel is enough.
    """
    from synth.camera.render import SAMPLES, render

    x, y, width, height = window or (0, 0, optics.width_px, optics.height_px)
    scene = part_scene(part, model)
    pixels = window_pixels(x, y, width, height)
    near = _near(part, optics, pixels)
    radiance = np.empty(width * height, np.float32)
    for chosen, samples in ((near, SAMPLES), (~near, 1)):
        if chosen.any():
            radiance[chosen] = render(scene, optics, pixels[chosen], samples).radiance
    return expose(radiance.reshape(height, width), part, optics, (x, y))


def band(part: Part, model: WeldModel, optics: Optics) -> tuple[Image, Map, Window]:
    """Render the band that the crops show, with heights in mm, in the window round the ring."""
    from synth.camera.render import render

    window = ring_window(part, optics)
    x, y, width, height = window
    pixels = window_pixels(x, y, width, height)
    near = _near(part, optics, pixels)
    seen = render(part_scene(part, model), optics, pixels[near])
    radiance, heights = np.zeros(width * height, np.float32), np.zeros(width * height, np.float32)
    radiance[near], heights[near] = seen.radiance, seen.height_mm
    image = expose(radiance.reshape(height, width), part, optics, (x, y))
    return image, heights.reshape(height, width), window


def piece_crops(parts: Sequence[Part], model: WeldModel, optics: Optics) -> tuple[list[Image], Map, Map]:
    """Render the crops (128, 128) uint8 of straight pieces.

    Returns them with their heights in mm and their floor fractions, (K, 128, 128).
    """
    from synth.camera.render import render

    left, top, side, _ = piece_window(optics)
    x, y, wide = left - MARGIN_PX, top - MARGIN_PX, side + 2 * MARGIN_PX
    pixels = [window_pixels(x, y, wide, wide, tile=i) for i in range(len(parts))]
    seen = render(piece_scene(parts, model), optics, join_pixels(pixels))
    shape = (len(parts), wide, wide)
    inner = slice(MARGIN_PX, MARGIN_PX + side)
    radiance = seen.radiance.reshape(shape)
    images = [expose(radiance[i], part, optics, (x, y))[inner, inner] for i, part in enumerate(parts)]
    return images, seen.height_mm.reshape(shape)[:, inner, inner], seen.floor.reshape(shape)[:, inner, inner]


def piece_window(optics: Optics) -> Window:
    """Return the window of a straight piece's crop: the middle of the frame."""
    return optics.width_px // 2 - CROP_PX // 2, optics.height_px // 2 - CROP_PX // 2, CROP_PX, CROP_PX


def _near(part: Part, optics: Optics, pixels: Pixels) -> NDArray[np.bool_]:
    """Return which pixels lie in the band round the weld, (P,)."""
    x, y, radius = ring_px(part, optics)
    away = np.hypot(pixels.x_px - np.float32(x), pixels.y_px - np.float32(y))
    return np.asarray(np.abs(away - np.float32(radius)) < BAND_PX)

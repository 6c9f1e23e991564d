"""Rendered parts as camera pictures: whole frames, windows, the band round the weld, and flat crops.

The renderer is loaded when the first picture is asked for: planning and reading need none.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENT_PX, STRIP_ROWS
from synth.camera.optics import Optics
from synth.camera.projection import ring_px
from synth.camera.scene import Pixels, flat_scene, join_pixels, part_scene, window_pixels
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
"""Half the width of the band round the weld's centre line that its crops can show, with room for a moved ring and the blur."""
CROP_PX = SEGMENT_PX
MARGIN_PX = 8
"""Rendered round a flat crop for the blur."""


def ring_window(part: Part, optics: Optics) -> Window:
    """Window round the ring, inside the frame."""
    x, y, _ = ring_px(part, optics)
    half = RING_WINDOW_PX // 2
    left = int(np.clip(round(x) - half, 0, optics.width_px - RING_WINDOW_PX))
    top = int(np.clip(round(y) - half, 0, optics.height_px - RING_WINDOW_PX))
    return left, top, RING_WINDOW_PX, RING_WINDOW_PX


def picture(part: Part, model: WeldModel, optics: Optics, window: Window | None = None) -> Image:
    """Camera picture (H, W) uint8 of a window, by default the whole frame. Away from the weld one ray a pixel is enough."""
    from synth.camera.render import SAMPLES, render

    x, y, width, height = window or (0, 0, optics.width_px, optics.height_px)
    scene = part_scene(part, model)
    pixels = window_pixels(x, y, width, height)
    near = _near(part, optics, pixels)
    radiance = np.empty(width * height, np.float32)
    for chosen, samples in ((near, SAMPLES), (~near, 1)):
        if chosen.any():
            radiance[chosen] = render(scene, optics, _pick(pixels, chosen), samples).radiance
    return expose(radiance.reshape(height, width), part, optics, (x, y))


def band(part: Part, model: WeldModel, optics: Optics) -> tuple[Image, Map, Window]:
    """Camera picture of the window round the ring, rendered in the band that the crops show and black elsewhere; heights in mm."""
    from synth.camera.render import render

    window = ring_window(part, optics)
    x, y, width, height = window
    pixels = window_pixels(x, y, width, height)
    near = _near(part, optics, pixels)
    seen = render(part_scene(part, model), optics, _pick(pixels, near))
    radiance, heights = np.zeros(width * height, np.float32), np.zeros(width * height, np.float32)
    radiance[near], heights[near] = seen.radiance, seen.height_mm
    return expose(radiance.reshape(height, width), part, optics, (x, y)), heights.reshape(height, width), window


def flat_crops(parts: Sequence[Part], model: WeldModel, optics: Optics) -> tuple[list[Image], Map, Map]:
    """Flat crops (128, 128) uint8 of parts drawn flat; their heights in mm and floor shares, (K, 128, 128)."""
    from synth.camera.render import render

    x, y, side, _ = flat_window(optics)
    pixels = [window_pixels(x - MARGIN_PX, y - MARGIN_PX, side + 2 * MARGIN_PX, side + 2 * MARGIN_PX, i) for i in range(len(parts))]
    seen = render(flat_scene(parts, model), optics, join_pixels(pixels))
    shape = (len(parts), side + 2 * MARGIN_PX, side + 2 * MARGIN_PX)
    inner = slice(MARGIN_PX, MARGIN_PX + side)
    radiance = seen.radiance.reshape(shape)
    images = [expose(radiance[i], part, optics, (x - MARGIN_PX, y - MARGIN_PX))[inner, inner] for i, part in enumerate(parts)]
    return images, seen.height_mm.reshape(shape)[:, inner, inner], seen.floor.reshape(shape)[:, inner, inner]


def flat_window(optics: Optics) -> Window:
    """Window of a flat crop: the middle of the frame."""
    return optics.width_px // 2 - CROP_PX // 2, optics.height_px // 2 - CROP_PX // 2, CROP_PX, CROP_PX


def _near(part: Part, optics: Optics, pixels: Pixels) -> NDArray[np.bool_]:
    x, y, radius = ring_px(part, optics)
    away = np.hypot(pixels.x_px - np.float32(x), pixels.y_px - np.float32(y))
    return np.asarray(np.abs(away - np.float32(radius)) < BAND_PX)


def _pick(pixels: Pixels, chosen: NDArray[np.bool_]) -> Pixels:
    return Pixels(pixels.x_px[chosen], pixels.y_px[chosen], pixels.tile[chosen])

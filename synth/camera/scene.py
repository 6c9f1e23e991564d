"""Parts to a scene as data: meshes, surfaces, lights and the camera rays that are asked for. numpy only.

One scene holds one part as a camera frame sees it, or many flat crops side by side: each of these has its own camera and lights
right above it, so that one ray tracing serves all.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from synth.camera.lights import Lights, lights
from synth.measured.spectrum import WeldModel
from synth.part.geometry import PIECE_MM
from synth.part.part import Part
from synth.surface.materials import Surface, bead_surface, floor_reflectance, plate_surface
from synth.surface.mesh import Mesh, join, moved, part_meshes

TILE_MM = PIECE_MM + 0.6
"""Distance between the straight pieces of one scene."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """All that one ray tracing needs; per tile: its part, lights and the x in mm of its camera's axis."""

    parts: tuple[Part, ...]
    meshes: dict[str, Mesh]
    bead: Surface
    plate: Surface
    floor: NDArray[np.float32]
    """Reflectance (H, W) of what lies below holes and joint."""
    lights: tuple[Lights, ...]
    origin_mm: tuple[float, ...] = field(default=(0.0,))


def part_scene(part: Part, model: WeldModel) -> Scene:
    """Scene of one whole part."""
    bead = bead_surface(part, part.geometry.length_mm)
    return Scene((part,), part_meshes(part, model), bead, plate_surface(part), floor_reflectance(part), (lights(part, part.switches),))


def flat_scene(parts: Sequence[Part], model: WeldModel) -> Scene:
    """Scene of flat crops, one tile each."""
    tiles = len(parts)
    origins = tuple((i - (tiles - 1) / 2) * TILE_MM for i in range(tiles))
    meshes: dict[str, list[Mesh]] = {}
    for i, part in enumerate(parts):
        for name, mesh in part_meshes(part, model).items():
            meshes.setdefault(name, []).append(moved(mesh, origins[i], i, tiles))
    beads = [bead_surface(part, part.geometry.length_mm) for part in parts]
    plates = [plate_surface(part) for part in parts]
    return Scene(
        tuple(parts),
        {name: join(of_name) for name, of_name in meshes.items()},
        _side_by_side(beads),
        _side_by_side(plates),
        np.concatenate([floor_reflectance(part) for part in parts], axis=1),
        tuple(lights(part, part.switches) for part in parts),
        origins,
    )


def _side_by_side(surfaces: list[Surface]) -> Surface:
    return Surface(np.concatenate([s.reflectance for s in surfaces], axis=1), np.concatenate([s.soot for s in surfaces], axis=1))


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """Which pixels to render: x_px, y_px (P,) float32 in the whole frame of the tile's camera, tile (P,) uint32."""

    x_px: NDArray[np.float32]
    y_px: NDArray[np.float32]
    tile: NDArray[np.uint32]


def window_pixels(x: int, y: int, width: int, height: int, tile: int = 0) -> Pixels:
    """All pixels of a window, row by row."""
    rows, columns = np.indices((height, width), np.float32)
    return Pixels((columns + x).ravel(), (rows + y).ravel(), np.full(width * height, tile, np.uint32))


def join_pixels(pixels: Sequence[Pixels]) -> Pixels:
    """Pixels of several tiles."""
    return Pixels(*(np.concatenate([getattr(p, name) for p in pixels]) for name in ("x_px", "y_px", "tile")))

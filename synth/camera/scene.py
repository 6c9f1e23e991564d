"""Parts to a scene as data: meshes, surfaces, lights and the camera rays to trace. numpy only.

One scene holds one part as a camera frame shows it, or many straight pieces side by side: each of these has
its own camera and lights right above it, so that one ray tracing serves all.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from synth.camera.lights import Lights, lights
from synth.measured.spectrum import WeldModel
from synth.part.geometry import PIECE_MM
from synth.part.part import Part
from synth.surface.materials import SurfaceMaps, bead_maps, floor_reflectance, plate_maps
from synth.surface.mesh import Mesh, join, moved, part_meshes

TILE_MM = PIECE_MM + 0.6
"""Distance between two straight pieces of one scene."""


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What one ray tracing needs; per tile: its part, lights and the x in mm of its camera's axis."""

    parts: tuple[Part, ...]
    meshes: dict[str, Mesh]
    bead: SurfaceMaps
    plate: SurfaceMaps
    floor: NDArray[np.float32]
    """Reflectance (H, W) of what lies below holes and joint."""
    lights: tuple[Lights, ...]
    origin_mm: tuple[float, ...] = field(default=(0.0,))


def part_scene(part: Part, model: WeldModel) -> Scene:
    """Return the scene of one whole part."""
    return Scene(
        parts=(part,),
        meshes=part_meshes(part, model),
        bead=bead_maps(part),
        plate=plate_maps(part),
        floor=floor_reflectance(part),
        lights=(lights(part.light, part.switches),),
    )


def piece_scene(parts: Sequence[Part], model: WeldModel) -> Scene:
    """Return the scene of straight pieces, one tile each."""
    tiles = len(parts)
    origins = tuple((i - (tiles - 1) / 2) * TILE_MM for i in range(tiles))
    meshes: dict[str, list[Mesh]] = {}
    for i, part in enumerate(parts):
        for name, mesh in part_meshes(part, model).items():
            meshes.setdefault(name, []).append(moved(mesh, origins[i], i, tiles))
    return Scene(
        parts=tuple(parts),
        meshes={name: join(of_name) for name, of_name in meshes.items()},
        bead=_side_by_side([bead_maps(part) for part in parts]),
        plate=_side_by_side([plate_maps(part) for part in parts]),
        floor=np.concatenate([floor_reflectance(part) for part in parts], axis=1),
        lights=tuple(lights(part.light, part.switches) for part in parts),
        origin_mm=origins,
    )


def _side_by_side(maps: list[SurfaceMaps]) -> SurfaceMaps:
    return SurfaceMaps(
        np.concatenate([m.reflectance for m in maps], axis=1), np.concatenate([m.soot for m in maps], axis=1)
    )


@dataclass(frozen=True, slots=True, eq=False)
class Pixels:
    """Pixels to render: x_px, y_px (P,) float32 in the whole frame of the tile's camera, tile (P,) uint32."""

    x_px: NDArray[np.float32]
    y_px: NDArray[np.float32]
    tile: NDArray[np.uint32]

    def __getitem__(self, chosen: slice | NDArray[np.bool_]) -> "Pixels":
        """Return some of the pixels."""
        return Pixels(self.x_px[chosen], self.y_px[chosen], self.tile[chosen])


def window_pixels(x: int, y: int, width: int, height: int, *, tile: int = 0) -> Pixels:
    """Return the pixels of a window, row by row."""
    rows, columns = np.indices((height, width), np.float32)
    return Pixels((columns + x).ravel(), (rows + y).ravel(), np.full(width * height, tile, np.uint32))


def join_pixels(pixels: Sequence[Pixels]) -> Pixels:
    """Join the pixels of several tiles."""
    return Pixels(*(np.concatenate([getattr(p, name) for p in pixels]) for name in ("x_px", "y_px", "tile")))

"""Part to triangle meshes, numpy only. Vertices in world coordinates: x right, y up, z to the camera, mm."""

from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.defects.hole import hole_mask
from synth.measured.spectrum import WeldModel
from synth.part.part import Part
from synth.part.pose import pose
from synth.part.streams import Stream, stream
from synth.surface.contour import Contour, contour
from synth.surface.topography import relief

Array = NDArray[np.float64]

ACROSS = 80
"""Lines of the bead's grid from border to border."""
PIECE_FRACTION = 0.15
"""Fraction of a part's droplets and fibres that a straight piece has: by length it would be 0.06, too few to tell droplets from holes."""
FLOOR_MM = -0.45
"""Height of what lies below the joint."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """Triangles with shading normals and texture coordinates.

    vertices, normals (V, 3) float32 mm; uv (V, 2) float32; faces (F, 3) uint32.
    """

    vertices: NDArray[np.float32]
    normals: NDArray[np.float32]
    uv: NDArray[np.float32]
    faces: NDArray[np.uint32]


def part_meshes(part: Part, model: WeldModel) -> dict[str, Mesh]:
    """Meshes by material: "plate" (both partners and spatter), "floor", "bead" (absent without any weld), "fibre" (if any)."""
    theta = part.geometry.angles()
    line = contour(part, theta)
    inner_end, outer_end = part.geometry.partner_edges_mm(theta)
    inner = inner_end + np.linspace(0.0, 1.0, 5)[:, None] * (line.inner_mm - inner_end)
    share = np.array([0.0, 0.02, 0.1, 0.4, 1.0])[:, None]
    outer = line.outer_mm + share * (outer_end - line.outer_mm)
    plates = [_plate(part, theta, inner, part.step_mm), _plate(part, theta, outer, 0.0)]
    floor = _plate(part, theta, np.array([[-1.2], [1.2]]) + part.radius_mm + 0 * theta, FLOOR_MM)
    meshes = {"floor": floor}
    height = None
    if line.present.any():
        meshes["bead"], height = _bead(part, theta, line, model)
    plates += _spatter(part, line, theta, height)
    meshes["plate"] = join(plates)
    fibres = _fibres(part)
    if fibres:
        meshes["fibre"] = join(fibres)
    return meshes


def join(meshes: list[Mesh]) -> Mesh:
    """One mesh of several."""
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.uv for m in meshes]),
        np.concatenate([m.faces + np.uint32(s) for m, s in zip(meshes, starts, strict=True)]),
    )


def moved(mesh: Mesh, x_mm: float, tile: int, tiles: int) -> Mesh:
    """The mesh `x_mm` further right, its texture coordinates in tile number `tile` of an atlas of `tiles` side by side."""
    uv = np.asarray((mesh.uv + np.array([tile, 0], np.float32)) / np.array([tiles, 1], np.float32), np.float32)
    return replace(mesh, vertices=mesh.vertices + np.array([x_mm, 0, 0], np.float32), uv=uv)


def _plate(part: Part, theta: Array, radius_mm: Array, z_mm: float) -> Mesh:
    """Flat rings: radius_mm (K, M), innermost first."""
    points = part.geometry.embed(theta, radius_mm, np.array(z_mm))
    normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
    return _mesh(part, points, normals, _plan_uv(part, points), np.ones((radius_mm.shape[0] - 1, theta.size), bool))


def _plan_uv(part: Part, points: Array) -> Array:
    return np.asarray(points[..., :2] / part.geometry.plate_mm + 0.5)


def _bead(part: Part, theta: Array, line: Contour, model: WeldModel) -> tuple[Mesh, Array]:
    """The bead, and its height (N, M), NaN over holes."""
    t = np.linspace(-1.0, 1.0, ACROSS)
    z = relief(part, theta, t, model)
    hole = hole_mask(part, theta, line, ACROSS)
    if hole.any():
        z = z - _rim_sink(part, hole, theta)
    below, above = np.clip(-t, 0, 1)[:, None], np.clip(t, 0, 1)[:, None]
    radius = line.center_mm + above * (line.outer_mm - line.center_mm) + below * (line.inner_mm - line.center_mm)
    lift = np.clip((line.outer_mm - line.inner_mm) / part.half_width_mm, 0, 1)
    height = z.T * lift + part.step_mm * (1 - t[:, None]) / 2
    points = part.geometry.embed(theta, radius, height)
    normals = np.cross(np.gradient(points, axis=0), part.geometry.along(points))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True) + 1e-12
    start, end = part.geometry.ends_rad
    u = (theta - start) / (end - start)
    uv = np.stack(np.broadcast_arrays(u[None, :], ((t + 1) / 2)[:, None]), axis=-1)
    keep = ~hole.T[:-1] & line.present[None, :] & np.roll(line.present, -1)[None, :]
    return _mesh(part, points, normals, uv, keep), np.where(hole.T, np.nan, height)


def _rim_sink(part: Part, hole: NDArray[np.bool_], theta: Array) -> Array:
    """The melt sinks towards a hole's edge, or is heaped up to a lip round it: depth (M, N) in mm. Cells are nearly square."""
    wrapped = np.concatenate([hole[-64:], hole, hole[:64]])
    cells = cv2.distanceTransform((~wrapped).astype(np.uint8), cv2.DIST_L2, 3)[64:-64]
    away_mm = cells.astype(np.float64) * float(theta[1] - theta[0]) * part.radius_mm
    return part.hole_rim_mm * np.exp(-(((away_mm - part.hole_crest_mm) / part.hole_rim_width_mm) ** 2))


def _spatter(part: Part, line: Contour, theta: Array, height: Array | None) -> list[Mesh]:
    """Droplets: domes on the partners or on the bead, none over a hole."""
    rng = stream(part.seed, Stream.SPATTER)
    found = []
    for _ in range(part.geometry.number(rng, part.spatter, PIECE_FRACTION)):
        at = float(rng.uniform(theta[0], theta[-1]))
        away_mm = float(rng.laplace(0.0, 0.5))
        size_mm = float(np.exp(rng.uniform(np.log(0.015), np.log(0.11))))
        index = int(np.searchsorted(theta, at)) % theta.size
        radius = part.radius_mm + np.sign(away_mm) * min(abs(away_mm), 1.05)
        base = part.step_mm if radius < line.inner_mm[index] else 0.0
        if line.inner_mm[index] <= radius <= line.outer_mm[index]:
            if height is None or not line.present[index]:
                continue
            share = (radius - line.inner_mm[index]) / (line.outer_mm[index] - line.inner_mm[index])
            base = float(height[round(share * (ACROSS - 1)), index])
            if np.isnan(base):
                continue
        found.append(_dome(part, at, radius, base, size_mm, float(rng.uniform(0.3, 0.9))))
    return found


def _dome(part: Part, at_rad: float, radius_mm: float, base_mm: float, size_mm: float, flatness: float) -> Mesh:
    polar, around = np.meshgrid(np.linspace(0.02, np.pi / 2, 8), np.linspace(0, 2 * np.pi, 20, endpoint=False), indexing="ij")
    local = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), flatness * np.cos(polar)], axis=-1)
    points = part.geometry.embed(np.array(at_rad), np.array(radius_mm), np.array(base_mm)) + size_mm * local
    normals = local / np.array([1.0, 1.0, flatness**2])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return _mesh(part, points, normals, _plan_uv(part, points), np.ones((7, 20), bool), closed=True)


def _fibres(part: Part) -> list[Mesh]:
    """Thin curved ribbons just above the surface."""
    rng = stream(part.seed, Stream.FIBRES)
    found = []
    for _ in range(part.geometry.number(rng, part.fibres, PIECE_FRACTION)):
        theta = float(rng.uniform(*part.geometry.ends_rad))
        start = part.geometry.embed(np.array(theta), np.array(part.radius_mm + rng.normal(0, 0.5)), np.array(0.1))
        steps = np.linspace(0, 1, 40)
        heading = rng.uniform(0, 2 * np.pi) + rng.normal(0, 1.2) * steps + rng.normal(0, 1.0) * steps**2
        length = float(rng.uniform(0.6, 3.5))
        curve = np.cumsum(np.stack([np.cos(heading), np.sin(heading), 0 * heading], axis=1), axis=0) * length / 40
        side = np.stack([-np.sin(heading), np.cos(heading), 0 * heading], axis=1) * float(rng.uniform(0.006, 0.014))
        points = start + np.stack([curve + side, curve - side])
        normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
        found.append(_mesh(part, points, normals, np.full((*points.shape[:2], 2), 0.5), np.ones((1, 40), bool), closed=False))
    return found


def _mesh(part: Part, points: Array, normals: Array, uv: Array, keep: NDArray[np.bool_], closed: bool | None = None) -> Mesh:
    """Join a (K, M, 3) grid of points, closed along its second axis round a ring, into triangles; `keep` (K - 1, M) selects cells."""
    around = points.shape[1]
    if not (part.geometry.is_closed if closed is None else closed):
        keep = keep & (np.arange(around) < around - 1)[None, :]
    k, m = np.nonzero(keep)
    right = (m + 1) % around
    a, b, c, d = k * around + m, k * around + right, (k + 1) * around + m, (k + 1) * around + right
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
    matrix = pose(part)
    world = points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]
    turned = normals.reshape(-1, 3) @ matrix[:3, :3].T
    return Mesh(
        world.astype(np.float32),
        turned.astype(np.float32),
        uv.reshape(-1, 2).astype(np.float32),
        faces.astype(np.uint32),
    )

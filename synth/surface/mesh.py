"""Part to triangle meshes, numpy only. Vertices in world coordinates: x right, y up, z to the camera, mm."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from synth.measured.spectrum import WeldModel
from synth.part.borders import Borders, Cells
from synth.part.part import Part
from synth.part.streams import Stream, stream
from synth.surface.contour import contour
from synth.surface.topography import relief

Array = NDArray[np.float64]

ACROSS = 80
"""Lines of the bead's grid from border to border."""
PIECE_FRACTION = 0.15
"""Fraction of a part's droplets and fibres on a straight piece; by length 0.06, too few to learn droplets."""
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
    """Return meshes by material: "plate" (with spatter), "floor"; "bead" and "fibre" if there are any."""
    theta = part.geometry.angles()
    borders = contour(part, theta)
    inner_end, outer_end = part.geometry.partner_edges_mm(theta)
    inner = inner_end + np.linspace(0.0, 1.0, 5)[:, None] * (borders.inner_mm - inner_end)
    outwards = np.array([0.0, 0.02, 0.1, 0.4, 1.0])[:, None]
    outer = borders.outer_mm + outwards * (outer_end - borders.outer_mm)
    plates = [_plate(part, theta, inner, part.joint.step_mm), _plate(part, theta, outer, 0.0)]
    floor = _plate(part, theta, np.array([[-1.2], [1.2]]) + part.bead.radius_mm + 0 * theta, FLOOR_MM)
    meshes = {"floor": floor}
    height = None
    if borders.present.any():
        meshes["bead"], height = _bead(part, borders, model)
    plates += _spatter(part, borders, height)
    meshes["plate"] = join(plates)
    fibres = _fibres(part)
    if fibres:
        meshes["fibre"] = join(fibres)
    return meshes


def join(meshes: list[Mesh]) -> Mesh:
    """Join several meshes to one."""
    starts = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    return Mesh(
        np.concatenate([m.vertices for m in meshes]),
        np.concatenate([m.normals for m in meshes]),
        np.concatenate([m.uv for m in meshes]),
        np.concatenate([m.faces + np.uint32(start) for m, start in zip(meshes, starts, strict=True)]),
    )


def moved(mesh: Mesh, x_mm: float, tile: int, tiles: int) -> Mesh:
    """Return the mesh `x_mm` further right, its texture in place `tile` of an atlas of `tiles` in a row."""
    uv = np.asarray(
        (mesh.uv + np.array([tile, 0], np.float32)) / np.array([tiles, 1], np.float32), np.float32
    )
    return replace(mesh, vertices=mesh.vertices + np.array([x_mm, 0, 0], np.float32), uv=uv)


def _plate(part: Part, theta: Array, radius_mm: Array, z_mm: float) -> Mesh:
    """Return flat rings: radius_mm (K, M), innermost first."""
    points = part.geometry.embed(theta, radius_mm, np.array(z_mm))
    normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
    keep = np.ones((radius_mm.shape[0] - 1, theta.size), bool)
    return _mesh(
        part, points, normals, uv=_seen_from_above(part, points), keep=keep, is_closed=part.geometry.is_closed
    )


def _seen_from_above(part: Part, points: Array) -> Array:
    """Return the texture coordinates of points on the partners."""
    return np.asarray(points[..., :2] / part.geometry.plate_mm + 0.5)


def _bead(part: Part, borders: Borders, model: WeldModel) -> tuple[Mesh, Array]:
    """Return the bead, and its height (N, M), NaN where a defect has removed it."""
    theta, t = borders.theta_rad, np.linspace(-1.0, 1.0, ACROSS)
    removed = _removed(part, borders)
    z = relief(part, theta, t, model) + _raised_mm(part, borders)
    below, above = np.clip(-t, 0, 1)[:, None], np.clip(t, 0, 1)[:, None]
    outwards, inwards = borders.outer_mm - borders.center_mm, borders.inner_mm - borders.center_mm
    radius = borders.center_mm + above * outwards + below * inwards
    lift = np.clip((borders.outer_mm - borders.inner_mm) / part.bead.half_width_mm, 0, 1)
    height = z.T * lift + part.joint.step_mm * (1 - t[:, None]) / 2
    points = part.geometry.embed(theta, radius, height)
    normals = np.cross(np.gradient(points, axis=0), part.geometry.along(points))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True) + 1e-12
    start, end = part.geometry.ends_rad
    u = (theta - start) / (end - start)
    uv = np.stack(np.broadcast_arrays(u[None, :], ((t + 1) / 2)[:, None]), axis=-1)
    keep = ~removed.T[:-1] & borders.present[None, :] & np.roll(borders.present, -1)[None, :]
    mesh = _mesh(part, points, normals, uv=uv, keep=keep, is_closed=part.geometry.is_closed)
    return mesh, np.where(removed.T, np.nan, height)


def _removed(part: Part, borders: Borders) -> Cells:
    """Return the cells (M, N) of the bead's grid that defects remove."""
    removed = np.zeros((borders.theta_rad.size, ACROSS), bool)
    for defect in part.defects:
        cells = defect.cut(borders, ACROSS)
        if cells is not None:
            removed |= cells
    return removed


def _raised_mm(part: Part, borders: Borders) -> Array:
    """Return by how much defects raise the bead (M, N); where several do, the largest change counts."""
    raised = np.zeros((borders.theta_rad.size, ACROSS))
    for defect in part.defects:
        change = defect.raise_mm(borders, ACROSS)
        if change is not None:
            raised = np.where(np.abs(change) > np.abs(raised), change, raised)
    return raised


def _spatter(part: Part, borders: Borders, height: Array | None) -> list[Mesh]:
    """Return droplets: domes on the partners or on the bead, none over a hole."""
    rng = stream(part.seed, Stream.SPATTER)
    theta, inner, outer = borders.theta_rad, borders.inner_mm, borders.outer_mm
    found = []
    for _ in range(part.geometry.number(rng, part.dirt.spatter, PIECE_FRACTION)):
        at = float(rng.uniform(theta[0], theta[-1]))
        away_mm = float(rng.laplace(0.0, 0.5))
        size_mm = float(np.exp(rng.uniform(np.log(0.015), np.log(0.11))))
        index = int(np.searchsorted(theta, at)) % theta.size
        radius = part.bead.radius_mm + np.sign(away_mm) * min(abs(away_mm), 1.05)
        base = part.joint.step_mm if radius < inner[index] else 0.0
        if inner[index] <= radius <= outer[index]:
            if height is None or not borders.present[index]:
                continue
            across = (radius - inner[index]) / (outer[index] - inner[index])
            base = float(height[round(across * (ACROSS - 1)), index])
            if np.isnan(base):
                continue
        foot = part.geometry.embed(np.array(at), np.array(radius), np.array(base))
        found.append(_dome(part, foot, size_mm, float(rng.uniform(0.3, 0.9))))
    return found


def _dome(part: Part, foot: Array, size_mm: float, flatness: float) -> Mesh:
    polar, around = np.meshgrid(
        np.linspace(0.02, np.pi / 2, 8), np.linspace(0, 2 * np.pi, 20, endpoint=False), indexing="ij"
    )
    local = np.stack(
        [np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), flatness * np.cos(polar)], axis=-1
    )
    points = foot + size_mm * local
    normals = local / np.array([1.0, 1.0, flatness**2])
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    keep = np.ones((7, 20), bool)
    return _mesh(part, points, normals, uv=_seen_from_above(part, points), keep=keep, is_closed=True)


def _fibres(part: Part) -> list[Mesh]:
    """Return thin curved ribbons just above the surface."""
    rng = stream(part.seed, Stream.FIBRES)
    found = []
    for _ in range(part.geometry.number(rng, part.dirt.fibres, PIECE_FRACTION)):
        theta = np.array(rng.uniform(*part.geometry.ends_rad))
        start = part.geometry.embed(theta, np.array(part.bead.radius_mm + rng.normal(0, 0.5)), np.array(0.1))
        steps = np.linspace(0, 1, 40)
        heading = rng.uniform(0, 2 * np.pi) + rng.normal(0, 1.2) * steps + rng.normal(0, 1.0) * steps**2
        length = float(rng.uniform(0.6, 3.5))
        curve = (
            np.cumsum(np.stack([np.cos(heading), np.sin(heading), 0 * heading], axis=1), axis=0) * length / 40
        )
        side = np.stack([-np.sin(heading), np.cos(heading), 0 * heading], axis=1) * float(
            rng.uniform(0.006, 0.014)
        )
        points = start + np.stack([curve + side, curve - side])
        normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
        uv, keep = np.full((*points.shape[:2], 2), 0.5), np.ones((1, 40), bool)
        found.append(_mesh(part, points, normals, uv=uv, keep=keep, is_closed=False))
    return found


def _mesh(part: Part, points: Array, normals: Array, *, uv: Array, keep: Cells, is_closed: bool) -> Mesh:
    """Join a (K, M, 3) grid of points, which may close along its second axis, to triangles.

    `keep` (K - 1, M) selects cells.
    """
    around = points.shape[1]
    if not is_closed:
        keep = keep & (np.arange(around) < around - 1)[None, :]
    k, m = np.nonzero(keep)
    right = (m + 1) % around
    a, b, c, d = k * around + m, k * around + right, (k + 1) * around + m, (k + 1) * around + right
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
    turn = part.pose.matrix()[:3, :3]
    return Mesh(
        part.pose.to_world(points.reshape(-1, 3)).astype(np.float32),
        (normals.reshape(-1, 3) @ turn.T).astype(np.float32),
        uv.reshape(-1, 2).astype(np.float32),
        faces.astype(np.uint32),
    )

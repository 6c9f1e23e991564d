"""Part to triangle meshes, numpy only. Vertices in world coordinates: x right, y up, z to the camera, mm."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from synth.defects import hole_mask
from synth.part import Part
from synth.topography import Contour, contour, relief

Array = NDArray[np.float64]

ANGLES = 4096
ACROSS = 96
PLATE_MM = 24.0
"""Side of the square that the partners' texture covers."""
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


def part_meshes(part: Part) -> dict[str, Mesh]:
    """Meshes of a part by name: "bead" (absent without any weld), "inner", "outer", "floor"."""
    theta: Array = np.arange(ANGLES, dtype=np.float64) * (2 * np.pi / ANGLES)
    line = contour(part, theta)
    pose = _pose(part)
    meshes = {
        "inner": _plate(theta, np.linspace(0.0, 1.0, 5)[:, None] * line.inner_mm, part.step_mm, pose),
        "outer": _plate(theta, _towards(line.outer_mm, _rim(theta)), 0.0, pose),
        "floor": _plate(theta, np.array([[-1.2], [1.2]]) + part.radius_mm + 0 * theta, FLOOR_MM, pose),
    }
    if line.present.any():
        meshes["bead"] = _bead(part, theta, line, pose)
    return meshes


def _pose(part: Part) -> Array:
    """4 x 4 matrix from part coordinates (y down) to world coordinates (y up)."""
    ax, ay = np.deg2rad(part.tilt_deg)
    rx = np.array([[1, 0, 0], [0, np.cos(ax), -np.sin(ax)], [0, np.sin(ax), np.cos(ax)]])
    ry = np.array([[np.cos(ay), 0, np.sin(ay)], [0, 1, 0], [-np.sin(ay), 0, np.cos(ay)]])
    flip = np.diag([1.0, -1.0, 1.0])
    matrix = np.eye(4)
    matrix[:3, :3] = ry @ rx @ flip
    matrix[:2, 3] = part.center_mm[0], -part.center_mm[1]
    return matrix


def to_world(part: Part, points_mm: Array) -> Array:
    """Part coordinates (K, 3) to world coordinates (K, 3), mm."""
    pose = _pose(part)
    return np.asarray(points_mm @ pose[:3, :3].T + pose[:3, 3])


def _rim(theta: Array) -> Array:
    """Radius of the outer partner's edge: a rectangle of 22 x 20 mm with round corners (superellipse)."""
    return np.asarray((np.abs(np.cos(theta) / 11.0) ** 10 + np.abs(np.sin(theta) / 10.0) ** 10) ** -0.1)


def _towards(start_mm: Array, end_mm: Array) -> Array:
    share = np.array([0.0, 0.02, 0.1, 0.4, 1.0])[:, None]
    return np.asarray(start_mm + share * (end_mm - start_mm))


def _plate(theta: Array, radius_mm: Array, z_mm: float, pose: Array) -> Mesh:
    """Flat rings: radius_mm (K, M), innermost first."""
    x, y = radius_mm * np.cos(theta), radius_mm * np.sin(theta)
    points = np.stack([x, y, np.full_like(x, z_mm)], axis=-1)
    uv = np.stack([x, y], axis=-1) / PLATE_MM + 0.5
    normals = np.broadcast_to(np.array([0.0, 0.0, 1.0]), points.shape)
    return _mesh(points, normals, uv, np.ones((radius_mm.shape[0] - 1, theta.size), bool), pose)


def _bead(part: Part, theta: Array, line: Contour, pose: Array) -> Mesh:
    t = np.linspace(-1.0, 1.0, ACROSS)
    z = relief(part, theta, t)
    hole = hole_mask(part, theta, line.center_mm, part.half_width_mm, ACROSS)
    if hole.any():
        z = z - _rim_sink(hole)
    below, above = np.clip(-t, 0, 1)[:, None], np.clip(t, 0, 1)[:, None]
    radius = line.center_mm + above * (line.outer_mm - line.center_mm) + below * (line.inner_mm - line.center_mm)
    lift = np.clip((line.outer_mm - line.inner_mm) / part.half_width_mm, 0, 1)
    height = z.T * lift + part.step_mm * (1 - t[:, None]) / 2
    points = np.stack([radius * np.cos(theta), radius * np.sin(theta), height], axis=-1)
    along = np.roll(points, -1, axis=1) - np.roll(points, 1, axis=1)
    outwards = np.gradient(points, axis=0)
    normals = np.cross(outwards, along)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True) + 1e-12
    uv = np.stack(np.broadcast_arrays((theta / (2 * np.pi))[None, :], ((t + 1) / 2)[:, None]), axis=-1)
    keep = ~hole.T[:-1] & line.present[None, :] & np.roll(line.present, -1)[None, :]
    return _mesh(points, normals, uv, keep, pose)


def _rim_sink(hole: NDArray[np.bool_]) -> Array:
    """The melt sinks towards a hole's edge: depth (M, N) in mm."""
    wrapped = np.concatenate([hole[-64:], hole, hole[:64]])
    cells = cv2.distanceTransform((~wrapped).astype(np.uint8), cv2.DIST_L2, 3)[64:-64]
    return 0.03 * np.exp(-cells.astype(np.float64) / 3.0)


def _mesh(points: Array, normals: Array, uv: Array, keep: NDArray[np.bool_], pose: Array) -> Mesh:
    """Join a (K, M) grid of points, periodic along its second axis, into triangles; `keep` (K - 1, M) selects cells."""
    around = points.shape[1]
    k, m = np.nonzero(keep)
    right = (m + 1) % around
    a, b, c, d = k * around + m, k * around + right, (k + 1) * around + m, (k + 1) * around + right
    faces = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
    world = points.reshape(-1, 3) @ pose[:3, :3].T + pose[:3, 3]
    turned = normals.reshape(-1, 3) @ pose[:3, :3].T
    return Mesh(
        world.astype(np.float32),
        turned.astype(np.float32),
        uv.reshape(-1, 2).astype(np.float32),
        faces.astype(np.uint32),
    )

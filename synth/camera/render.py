"""Scene to linear radiance through Mitsuba 3; the only file that imports mitsuba and drjit.

Rays go only through the pixels that are asked for. Direct light is summed over all emitters at every hit, a strided share of them
per sample; one of these, drawn in proportion to what it gives, is tested for shadow (resampled importance sampling), so that only
half-shadows are noisy. Same scene, same bits: each pixel is summed in one thread.
"""

from dataclasses import dataclass
from typing import Any

import drjit as dr
import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from synth.camera.lights import Lights
from synth.camera.optics import Optics
from synth.camera.scene import Pixels, Scene
from synth.surface.materials import METALS, SOOT_REFLECTANCE, Surface
from synth.surface.mesh import FLOOR_MM, Mesh

SAMPLES = 4
CHUNK = 2_000_000
"""Pixels rendered at once: bounds the memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Rendering:
    """Per pixel (P,) float32: linear radiance, mean height of what is seen in mm, and the share of rays that reach the floor."""

    radiance: NDArray[np.float32]
    height_mm: NDArray[np.float32]
    floor: NDArray[np.float32]


def start(threads: int | None = None) -> str:
    """Choose the variant, CUDA if there is a GPU, else LLVM, and the number of threads; return its name."""
    if mi.variant() is None:
        mi.set_variant("cuda_ad_mono", "llvm_ad_mono")
    if threads is not None:
        dr.set_thread_count(threads)
    return str(mi.variant())


def render(scene: Scene, optics: Optics, pixels: Pixels, samples: int = SAMPLES) -> Rendering:
    """Render `pixels` with `samples` stratified rays each (a square number)."""
    start()
    traced = mitsuba_scene(scene)
    parts = [
        _shade(
            traced, scene, optics, Pixels(pixels.x_px[i : i + CHUNK], pixels.y_px[i : i + CHUNK], pixels.tile[i : i + CHUNK]), samples, i
        )
        for i in range(0, len(pixels.x_px), CHUNK)
    ]
    return Rendering(*(np.concatenate([p[k] for p in parts]) for k in range(3)))


def _shade(world: Any, scene: Scene, optics: Optics, pixels: Pixels, samples: int, first: int) -> tuple[NDArray[np.float32], ...]:
    count = len(pixels.x_px)
    positions, strength, sigma, emitters, lambertian = _emitters(scene.lights)
    tile = mi.UInt32(pixels.tile)
    origin = dr.gather(mi.Float, mi.Float([float(x) for x in scene.origin_mm]), tile)
    at_x, at_y = mi.Float(pixels.x_px), mi.Float(pixels.y_px)
    index = dr.arange(mi.UInt32, count) + first
    # neighbours' streams must not be alike, or their errors do not average out
    state, sequence = mi.sample_tea_32(mi.UInt32(scene.parts[0].seed & 0xFFFFFFFF), index)  # type: ignore[call-overload]
    rng: Any = mi.PCG32(size=count, initstate=mi.UInt64(state), initseq=mi.UInt64(sequence))  # type: ignore[operator]
    offset = mi.UInt32(rng.next_float32() * emitters)
    side = max(1, round(samples**0.5))
    radiance, height, floor = (dr.zeros(mi.Float, count) for _ in range(3))
    for sample in range(side * side):
        x = at_x + (sample % side + rng.next_float32()) / side - 0.5 - (optics.width_px / 2 - 0.5)
        y = at_y + (sample // side + rng.next_float32()) / side - 0.5 - (optics.height_px / 2 - 0.5)
        direction = dr.normalize(mi.Vector3f(x / optics.focal_px, -y / optics.focal_px, -1.0))
        hit = world.ray_intersect(mi.Ray3f(mi.Point3f(origin, 0.0, optics.distance_mm), direction))
        valid = hit.is_valid()
        base, shift = tile * emitters, mi.Point3f(origin, 0.0, 0.0)
        light, chosen, rng = _gather_light(  # type: ignore[no-untyped-call]
            hit.bsdf(), hit, valid, positions, strength, sigma, base, shift, offset + sample, side * side, emitters, lambertian, rng
        )
        to = dr.gather(mi.Point3f, positions, base + chosen) + shift
        lit = valid & (light > 0) & ~world.ray_test(hit.spawn_ray_to(to), valid & (light > 0))
        radiance += dr.select(lit, light, 0.0)
        height += dr.select(valid, hit.p.z, 0.0)
        floor += dr.select(valid & (hit.p.z < FLOOR_MM / 2), 1.0, 0.0)
    dr.eval(radiance, height, floor)
    return tuple(np.array(v / (side * side if v is not radiance else 1), dtype=np.float32) for v in (radiance, height, floor))


@dr.syntax
def _gather_light(  # type: ignore[no-untyped-def]
    bsdf, hit, valid, positions, strength, sigma, base, shift, first, stride, emitters, lambertian, rng
):
    """Sum over every `stride`-th emitter of BSDF times irradiance, and one emitter drawn in proportion to its part."""
    total = mi.Float(0.0)
    chosen = mi.UInt32(0)
    k = mi.UInt32(first % stride)
    context = mi.BSDFContext()
    while k < emitters:
        way = dr.gather(mi.Point3f, positions, base + k) + shift - hit.p
        square = dr.squared_norm(way)
        towards = way * dr.rsqrt(square)
        angle = dr.safe_acos(towards.z) / dr.gather(mi.Float, sigma, base + k)
        fall = dr.select(lambertian, towards.z, dr.exp(-0.5 * dr.square(angle)))
        value = bsdf.eval(context, hit, hit.to_local(towards), valid)
        given = value.x * fall * dr.gather(mi.Float, strength, base + k) / square
        total += given
        chosen = dr.select(rng.next_float32() * total < given, k, chosen)
        k += stride
    return total, chosen, rng


def _emitters(lights: tuple[Lights, ...]) -> tuple[Any, Any, Any, int, Any]:
    """All tiles' emitters in one array each; tiles with fewer are filled up with dark ones."""
    most = max(len(light.intensity) for light in lights)
    position, strength, sigma = np.ones((len(lights), most, 3)), np.zeros((len(lights), most)), np.ones((len(lights), most))
    for i, light in enumerate(lights):
        n = len(light.intensity)
        position[i, :n], strength[i, :n] = light.positions_mm, light.intensity
        sigma[i, :n] = 1.0 if light.lambertian else light.sigma_rad
    flat = position.reshape(-1, 3).astype(np.float32)
    points = mi.Point3f(mi.Float(flat[:, 0]), mi.Float(flat[:, 1]), mi.Float(flat[:, 2]))
    scale = mi.Float(strength.ravel().astype(np.float32))
    return points, scale, mi.Float(sigma.ravel().astype(np.float32)), most, mi.Bool(lights[0].lambertian)


def mitsuba_scene(scene: Scene) -> Any:
    """Shapes and materials as a Mitsuba scene, without lights."""
    parts = scene.parts
    eta, k = METALS[parts[0].material]
    floor = {"type": "diffuse", "reflectance": _bitmap(scene.floor)}
    materials = {
        "bead": _metal(scene.bead, [p.alpha_weld for p in parts], eta, k),
        "plate": _metal(scene.plate, [p.alpha_partner for p in parts], eta, k),
        "floor": mi.load_dict(floor),
        "fibre": mi.load_dict({"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.12}}),
    }
    return mi.load_dict({"type": "scene", **{name: _shape(name, mesh, materials[name]) for name, mesh in scene.meshes.items()}})


def _metal(surface: Surface, alpha: list[float], eta: float, k: float) -> Any:
    """Rough conductor, Beckmann, under a blended share of soot."""
    metal = {
        "type": "roughconductor",
        "distribution": "beckmann",
        "eta": {"type": "uniform", "value": eta},
        "k": {"type": "uniform", "value": k},
        "alpha": _row(alpha),
        "specular_reflectance": _bitmap(surface.reflectance),
    }
    if not surface.soot.any():
        return mi.load_dict(metal)
    soot = {"type": "diffuse", "reflectance": {"type": "uniform", "value": SOOT_REFLECTANCE}}
    return mi.load_dict({"type": "blendbsdf", "weight": _bitmap(surface.soot), "metal": metal, "soot": soot})


def _row(values: list[float]) -> dict[str, Any]:
    """One value per tile; a plain number if all are the same."""
    if len(set(values)) == 1:
        return {"type": "uniform", "value": values[0]}
    return {**_bitmap(np.asarray([values], np.float32)), "filter_type": "nearest"}


def _bitmap(values: NDArray[np.float32]) -> dict[str, Any]:
    bitmap = mi.Bitmap(np.ascontiguousarray(values)[:, :, None])
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}


def _shape(name: str, mesh: Mesh, bsdf: Any) -> Any:
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    shape = mi.Mesh(name, len(mesh.vertices), len(mesh.faces), has_vertex_normals=True, has_vertex_texcoords=True, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mesh.vertices.ravel()
    parameters["vertex_normals"] = mesh.normals.ravel()
    parameters["vertex_texcoords"] = mesh.uv.ravel()
    parameters["faces"] = mesh.faces.ravel()
    parameters.update()
    return shape

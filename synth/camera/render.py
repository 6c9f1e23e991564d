"""Scene to linear radiance through Mitsuba 3; the only file that imports mitsuba and drjit.

Rays go only through the requested pixels. Direct light is summed over all emitters at every hit, a strided
fraction of them per sample; one of these, drawn in proportion to what it gives, is tested for shadow
(resampled importance sampling), so that only half-shadows are noisy. Same scene, same bits: each pixel is
summed in one thread.
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
from synth.surface.materials import METALS, SOOT_REFLECTANCE, SurfaceMaps
from synth.surface.mesh import FLOOR_MM, Mesh

SAMPLES = 4
"""Rays through each pixel."""
CHUNK = 2_000_000
"""Pixels rendered at once: bounds the memory."""


@dataclass(frozen=True, slots=True, eq=False)
class Rendering:
    """Result per pixel (P,) float32: radiance, mean height in mm, fraction of rays that reach the floor."""

    radiance: NDArray[np.float32]
    height_mm: NDArray[np.float32]
    floor: NDArray[np.float32]


def start(threads: int | None = None) -> str:
    """Choose Mitsuba's variant (CUDA with a GPU, else LLVM) and threads; return the variant's name."""
    if mi.variant() is None:
        mi.set_variant("cuda_ad_mono", "llvm_ad_mono")
    if threads is not None:
        dr.set_thread_count(threads)
    return str(mi.variant())


def render(scene: Scene, optics: Optics, pixels: Pixels, samples: int = SAMPLES) -> Rendering:
    """Render `pixels` with `samples` stratified rays each (a square number)."""
    start()
    traced = mitsuba_scene(scene)
    chunks = [
        _shade(traced, scene, optics, pixels[first : first + CHUNK], samples=samples, first=first)
        for first in range(0, len(pixels.x_px), CHUNK)
    ]
    return Rendering(*(np.concatenate([p[k] for p in chunks]) for k in range(3)))


def _shade(
    world: Any, scene: Scene, optics: Optics, pixels: Pixels, *, samples: int, first: int
) -> tuple[NDArray[np.float32], ...]:
    """Return radiance, height and floor fraction of pixels, of which the first is number `first` of all."""
    count = len(pixels.x_px)
    positions, strength, sigma, emitters, lambertian = _emitters(scene.lights)
    tile = mi.UInt32(pixels.tile)
    origin = dr.gather(mi.Float, mi.Float([float(x) for x in scene.origin_mm]), tile)
    at_x, at_y = mi.Float(pixels.x_px), mi.Float(pixels.y_px)
    index = dr.arange(mi.UInt32, count) + first
    # neighbours' streams must not be alike, or their errors do not average out
    seed = mi.UInt32(scene.parts[0].seed & 0xFFFFFFFF)
    state, sequence = mi.sample_tea_32(seed, index)  # type: ignore[call-overload]
    rng: Any = mi.PCG32(size=count, initstate=mi.UInt64(state), initseq=mi.UInt64(sequence))  # type: ignore[operator]
    side = max(1, round(samples**0.5))
    # with more rays than emitters, each emitter must still meet every ray alike
    offset = mi.UInt32(rng.next_float32() * max(emitters, side * side))
    radiance, height, floor = (dr.zeros(mi.Float, count) for _ in range(3))
    for sample in range(side * side):
        x = at_x + (sample % side + rng.next_float32()) / side - 0.5 - (optics.width_px / 2 - 0.5)
        y = at_y + (sample // side + rng.next_float32()) / side - 0.5 - (optics.height_px / 2 - 0.5)
        direction = dr.normalize(mi.Vector3f(x / optics.focal_px, -y / optics.focal_px, -1.0))
        hit = world.ray_intersect(mi.Ray3f(mi.Point3f(origin, 0.0, optics.distance_mm), direction))
        valid = hit.is_valid()
        base, shift = tile * emitters, mi.Point3f(origin, 0.0, 0.0)
        light, chosen, rng = _gather_light(  # type: ignore[no-untyped-call]
            hit.bsdf(),
            hit,
            valid,
            rng,
            positions=positions,
            strength=strength,
            sigma=sigma,
            lambertian=lambertian,
            base=base,
            shift=shift,
            first=offset + sample,
            stride=side * side,
            emitters=emitters,
        )
        to = dr.gather(mi.Point3f, positions, base + chosen) + shift
        lit = valid & (light > 0) & ~world.ray_test(hit.spawn_ray_to(to), valid & (light > 0))
        radiance += dr.select(lit, light, 0.0)
        height += dr.select(valid, hit.p.z, 0.0)
        floor += dr.select(valid & (hit.p.z < FLOOR_MM / 2), 1.0, 0.0)
    dr.eval(radiance, height, floor)
    means = (radiance, height / (side * side), floor / (side * side))
    return tuple(np.array(values, dtype=np.float32) for values in means)


@dr.syntax
def _gather_light(  # type: ignore[no-untyped-def]
    bsdf, hit, valid, rng, *, positions, strength, sigma, lambertian, base, shift, first, stride, emitters
):
    """Sum BSDF times irradiance over every `stride`-th emitter, and draw one in proportion to its part."""
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
    """Return all tiles' emitters in one array each; tiles with fewer are filled up with dark ones."""
    most = max(len(light.intensity) for light in lights)
    position = np.ones((len(lights), most, 3))
    strength, sigma = np.zeros((len(lights), most)), np.ones((len(lights), most))
    for i, light in enumerate(lights):
        n = len(light.intensity)
        position[i, :n], strength[i, :n] = light.positions_mm, light.intensity
        sigma[i, :n] = 1.0 if light.lambertian else light.sigma_rad
    flat = position.reshape(-1, 3).astype(np.float32)
    points = mi.Point3f(mi.Float(flat[:, 0]), mi.Float(flat[:, 1]), mi.Float(flat[:, 2]))
    scale = mi.Float(strength.ravel().astype(np.float32))
    return points, scale, mi.Float(sigma.ravel().astype(np.float32)), most, mi.Bool(lights[0].lambertian)


def mitsuba_scene(scene: Scene) -> Any:
    """Return shapes and materials as a Mitsuba scene, without lights."""
    finishes = [part.surface for part in scene.parts]
    eta, k = METALS[finishes[0].material]
    floor = {"type": "diffuse", "reflectance": _bitmap(scene.floor)}
    materials = {
        "bead": _metal(scene.bead, [finish.alpha_weld for finish in finishes], eta, k),
        "plate": _metal(scene.plate, [finish.alpha_partner for finish in finishes], eta, k),
        "floor": mi.load_dict(floor),
        "fibre": mi.load_dict({"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.12}}),
    }
    shapes = {name: _shape(name, mesh, materials[name]) for name, mesh in scene.meshes.items()}
    return mi.load_dict({"type": "scene", **shapes})


def _metal(surface: SurfaceMaps, alpha: list[float], eta: float, k: float) -> Any:
    """Return a rough conductor (Beckmann) under a blended fraction of soot."""
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
    """Return one value per tile; a plain number if all are the same."""
    if len(set(values)) == 1:
        return {"type": "uniform", "value": values[0]}
    return {**_bitmap(np.asarray([values], np.float32)), "filter_type": "nearest"}


def _bitmap(values: NDArray[np.float32]) -> dict[str, Any]:
    bitmap = mi.Bitmap(np.ascontiguousarray(values)[:, :, None])
    return {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"}


def _shape(name: str, mesh: Mesh, bsdf: Any) -> Any:
    properties = mi.Properties()
    properties["mesh_bsdf"] = bsdf
    sizes = (len(mesh.vertices), len(mesh.faces))
    shape = mi.Mesh(name, *sizes, has_vertex_normals=True, has_vertex_texcoords=True, props=properties)
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = mesh.vertices.ravel()
    parameters["vertex_normals"] = mesh.normals.ravel()
    parameters["vertex_texcoords"] = mesh.uv.ravel()
    parameters["faces"] = mesh.faces.ravel()
    parameters.update()
    return shape

"""Part to linear radiance through Mitsuba 3; the only file that imports mitsuba."""

from typing import Any

import mitsuba as mi
import numpy as np
from numpy.typing import NDArray

from synth.materials import Texture, bead_texture, plate_texture
from synth.mesh import Mesh, part_meshes
from synth.optics import Optics
from synth.part import Part

Window = tuple[int, int, int, int]
"""x, y, width, height in pixels of the whole frame."""


def render(part: Part, optics: Optics, window: Window | None = None, samples: int = 16) -> NDArray[np.float32]:
    """Linear radiance (H, W) float32 of the window (default: the whole frame), row 0 on top."""
    if mi.variant() is None:
        mi.set_variant("llvm_ad_mono")
    x, y, width, height = window or (0, 0, optics.width_px, optics.height_px)
    scene: dict[str, Any] = {"type": "scene", "integrator": {"type": "direct", "emitter_samples": 2, "bsdf_samples": 0}}
    scene |= _lights(part, optics)
    plate = _metal(plate_texture(part), part.alpha_partner)
    bead = _metal(bead_texture(part), part.alpha_weld)
    floor = mi.load_dict({"type": "diffuse", "reflectance": {"type": "uniform", "value": part.floor_reflectance}})
    for name, mesh in part_meshes(part).items():
        scene[name] = _shape(name, mesh, {"bead": bead, "floor": floor}.get(name, plate))
    sensor = mi.load_dict(
        {
            "type": "perspective",
            "fov": optics.fov_x_deg,
            "fov_axis": "x",
            "near_clip": 1.0,
            "far_clip": 1000.0,
            "to_world": mi.ScalarTransform4f().look_at(origin=[0, 0, optics.distance_mm], target=[0, 0, 0], up=[0, 1, 0]),
            "film": {
                "type": "hdrfilm",
                "width": optics.width_px,
                "height": optics.height_px,
                "crop_offset_x": x,
                "crop_offset_y": y,
                "crop_width": width,
                "crop_height": height,
                "pixel_format": "luminance",
                "component_format": "float32",
                "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent", "sample_count": samples},
        }
    )
    image = mi.render(mi.load_dict(scene), sensor=sensor, seed=mi.UInt32(part.seed), spp=samples)
    return np.asarray(image, dtype=np.float32).reshape(height, width)


def _lights(part: Part, optics: Optics) -> dict[str, Any]:
    positions = optics.light_positions_mm()
    positions[:, :2] *= part.light_scale
    heading = np.deg2rad(part.light_heading_deg)
    side = (positions[:, 0] * np.cos(heading) - positions[:, 1] * np.sin(heading)) / np.abs(positions[:, :2]).max()
    power = 2.0e5 / len(positions) * (1.0 + part.light_lean * side)
    return {
        f"light_{i:02d}": {
            "type": "spot",
            "to_world": mi.ScalarTransform4f().look_at(origin=at.tolist(), target=[at[0], at[1], 0.0], up=[0, 1, 0]),
            "intensity": {"type": "uniform", "value": float(power[i])},
            "cutoff_angle": optics.light_opening_deg,
            "beam_width": 2.0,
        }
        for i, at in enumerate(positions)
    }


def _metal(reflectance: Texture, alpha: float) -> Any:
    bitmap = mi.Bitmap(np.ascontiguousarray(reflectance)[:, :, None])
    return mi.load_dict(
        {
            "type": "roughconductor",
            "material": "Al",
            "distribution": "beckmann",
            "alpha": alpha,
            "specular_reflectance": {"type": "bitmap", "bitmap": bitmap, "raw": True, "wrap_mode": "clamp"},
        }
    )


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

"""Compares the speed of the generator with a plain Mitsuba script that renders the same image, in turns."""

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np
from rich.console import Console
from rich.table import Table

from station.numbers import whole_option
from synth.camera.frames import piece_crops, piece_window
from synth.camera.optics import Optics
from synth.camera.render import mitsuba_scene, render, start
from synth.camera.scene import piece_scene, window_pixels
from synth.errors import SynthError
from synth.measured.measurement import SHIPPED, read_measurement
from synth.measured.spectrum import WeldModel, derive
from synth.output.dataset import Order, workers, write_dataset
from synth.output.plan import PIECES_PER_SHARD, Shard, plan_pieces, quotas
from synth.part.part import Part
from synth.part.switches import ALL
from synth.recipes.named import PAPER, WIDE
from synth.surface.mesh import part_meshes

SAMPLES = 64
"""Samples per pixel of the plain script, with two emitter samples each; its noise is then that of the
generator, which traces 4 rays to all emitters."""


def main(argv: Sequence[str] | None = None) -> int:
    """Measure both in turns, and print medians, their ratio and where the time of the generator goes."""
    parser = argparse.ArgumentParser(
        prog="bench-render", description="Compare the speed of the generator with a plain Mitsuba script."
    )
    parser.add_argument(
        "--rounds",
        type=whole_option,
        default=3,
        metavar="N",
        help="number of measurements (default: %(default)s)",
    )
    arguments = parser.parse_args(argv)
    if arguments.rounds < 1:
        parser.error("--rounds must be at least 1")
    try:
        run(arguments.rounds)
    except SynthError as error:
        print(f"bench-render: {error}", file=sys.stderr)
        return 2
    return 0


def run(rounds: int) -> None:
    """Measure flat crops and arcs with two workers, and the plain script with all threads."""
    model, optics = derive(read_measurement(SHIPPED)), Optics()
    start()
    shards = plan_pieces(5, quotas(12), PAPER, ALL)
    plain(shards[0].parts[0], model, optics)
    seconds: dict[str, list[float]] = {"plain script": [], "generator, flat": [], "generator, arcs": []}
    with workers(2) as pool, tempfile.TemporaryDirectory(prefix="weldgate-") as folder:
        make = partial(write_dataset, model=model, executor=pool, done=lambda _: None)
        kinds = {"generator, flat": (PAPER, True), "generator, arcs": (WIDE, False)}
        for name, (recipe, is_straight) in kinds.items():
            make(
                Path(folder) / name,
                Order(seed=1, count=48, recipe=recipe, switches=ALL, is_straight=is_straight),
            )
        for i in range(rounds):
            seconds["plain script"].append(
                _timed(lambda: [plain(part, model, optics) for part in shards[0].parts]) / 12
            )
            for name, (recipe, is_straight) in kinds.items():
                order = Order(seed=9 + i, count=240, recipe=recipe, switches=ALL, is_straight=is_straight)
                seconds[name].append(_timed(partial(make, Path(folder) / f"{name} {i}", order)) / 240)
    table = Table("", "crops per s, median", "ms per crop", "5000 crops, min", "times the plain script")
    base = float(np.median(seconds["plain script"]))
    for name, values in seconds.items():
        each = float(np.median(values))
        table.add_row(
            name, f"{1 / each:.1f}", f"{each * 1000:.1f}", f"{each * 5000 / 60:.1f}", f"{base / each:.1f}"
        )
    Console().print(table)
    _noise(shards[0], model, optics)
    _parts_of_the_time(model, optics)


def plain(part: Part, model: WeldModel, optics: Optics) -> np.ndarray:
    """Render one flat crop with one scene, Mitsuba's spots and direct integrator, and one call."""
    scene = piece_scene([part], model)
    world: dict[str, Any] = {
        "type": "scene",
        "integrator": {"type": "direct", "emitter_samples": 2, "bsdf_samples": 0},
    }
    world |= {f"shape_{i}": shape for i, shape in enumerate(mitsuba_scene(scene).shapes())}
    for i, (at, value) in enumerate(
        zip(scene.lights[0].positions_mm, scene.lights[0].intensity, strict=True)
    ):
        world[f"light_{i}"] = {
            "type": "spot",
            "to_world": mi.ScalarTransform4f().look_at(
                origin=at.tolist(), target=[at[0], at[1], 0.0], up=[0, 1, 0]
            ),
            "intensity": {"type": "uniform", "value": float(value)},
            "cutoff_angle": 35.0,
            "beam_width": 2.0,
        }
    field = float(2 * np.rad2deg(np.arctan(optics.width_px * optics.pixel_mm / 2 / optics.distance_mm)))
    crop = dict(
        zip(
            ("crop_offset_x", "crop_offset_y", "crop_width", "crop_height"), piece_window(optics), strict=True
        )
    )
    film = {
        "type": "hdrfilm",
        "width": optics.width_px,
        "height": optics.height_px,
        "pixel_format": "luminance",
        **crop,
    }
    view = mi.ScalarTransform4f().look_at(origin=[0, 0, optics.distance_mm], target=[0, 0, 0], up=[0, 1, 0])
    sensor = mi.load_dict(
        {
            "type": "perspective",
            "fov": field,
            "fov_axis": "x",
            "to_world": view,
            "film": {**film, "rfilter": {"type": "box"}},
        }
    )
    return np.asarray(
        mi.render(mi.load_dict(world), sensor=sensor, spp=SAMPLES, seed=mi.UInt32(part.seed & 0xFFFF))
    )


def _noise(shard: Shard, model: WeldModel, optics: Optics) -> None:
    """Print the noise of both renderings of the same crop, as a fraction of the signal."""
    part = shard.parts[0]
    theirs = plain(part, model, optics).reshape(128, 128)
    scene = piece_scene([part], model)
    pixels = window_pixels(*piece_window(optics))
    fine = render(scene, optics, pixels, 64).radiance.reshape(128, 128)
    rough = render(scene, optics, pixels).radiance.reshape(128, 128)
    scale = float(np.median(theirs / fine))
    noise = [float(np.sqrt(np.mean((image - fine) ** 2)) / fine.mean()) for image in (theirs / scale, rough)]
    Console().print(
        "error compared with 64 rays per pixel to all emitters: "
        f"plain script {noise[0]:.1%}, generator {noise[1]:.1%}"
    )


def _parts_of_the_time(model: WeldModel, optics: Optics) -> None:
    """Print where the time of the generator goes, in one process with all threads."""
    (shard,) = plan_pieces(6, quotas(PIECES_PER_SHARD), PAPER, ALL)
    piece_crops(shard.parts, model, optics)
    whole = _timed(lambda: piece_crops(shard.parts, model, optics))
    meshes = _timed(lambda: [part_meshes(part, model) for part in shard.parts])
    scene = _timed(lambda: piece_scene(shard.parts, model))
    Console().print(
        f"of {whole / PIECES_PER_SHARD * 1000:.0f} ms per flat crop in one process: "
        f"relief and meshes {meshes / whole:.0%}, textures {max(0.0, scene - meshes) / whole:.0%}, "
        f"ray tracing, light and sensor {(whole - scene) / whole:.0%}"
    )


def _timed(work: Callable[[], object]) -> float:
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


if __name__ == "__main__":
    sys.exit(main())

"""Datasets of labelled crops on disk, made by many workers; a killed run continues where it stopped.

manifest.json                         recipe, switches, seed, hashes: what is needed to make it again
images/{train,val}/KIND/NNNNNN.png    folders of "ok", "hole", … (ultralytics classify, anomalib Folder)
labels/…/NNNNNN.txt                   detection labels next to them (ultralytics detect, with data.yaml)
masks/…/NNNNNN.png                    255 where a defect is (anomalib)
heights/…/NNNNNN.tif                  on request: float32, um
coco_train.json, coco_val.json        boxes and polygons (COCO)
shards/NNNNN.json                     one per finished shard, written last: these are not made again
"""

import json
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from synth.camera.frames import CROP_PX
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.plan import CROP_KINDS, Shard, crop_fractions, plan_pieces, plan_rings, quotas
from synth.output.shard import DETECTED, Job, Made, make
from synth.output.storage import claim, write_bytes, write_text
from synth.part.recipe import Recipe
from synth.part.switches import Switch

FORMAT = 1
"""Version of the layout of a dataset."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """What a dataset is to hold."""

    seed: int
    count: int
    recipe: Recipe
    switches: frozenset[Switch]
    is_straight: bool = False
    """True for the paper's straight pieces, False for crops of rings as the station cuts them."""
    has_heights: bool = False
    """True if height maps are written as well."""


def write_dataset(
    out: Path, order: Order, model: WeldModel, *, executor: Executor | None, done: Callable[[int], None]
) -> None:
    """Make a dataset, or what is missing of it. `done` is called with the number of images of each shard.

    Without an executor all work is done in this process. Raises SynthError if `out` holds another dataset, a
    file cannot be written or a worker dies; what is finished stays and is not made again.
    """
    from synth.camera.render import start

    variant = start()
    plan = plan_pieces if order.is_straight else plan_rings
    shards = plan(order.seed, quotas(order.count), order.recipe, order.switches)
    manifest = _manifest(order, model, variant)
    claim(out / "order.json", manifest)
    left = []
    for shard in shards:
        if _shard_file(out, shard.index).exists():
            done(len(shard.crops))
        else:
            left.append(Job(shard, model, order.has_heights))
    for made in _all(left, executor):
        for name, content in made.files.items():
            write_bytes(out / name, content)
        write_text(_shard_file(out, made.index), json.dumps(made.images))
        done(len(made.images))
    _finish(out, shards, manifest)


def _all(jobs: list[Job], executor: Executor | None) -> Iterator[Made]:
    if executor is None:
        yield from map(make, jobs)
        return
    waiting = {executor.submit(make, job) for job in jobs}
    try:
        for future in as_completed(waiting):
            yield future.result()
    except BrokenProcessPool:
        advice = "run the command again to continue, with fewer --workers if need be"
        raise SynthError(f"a worker was killed (out of memory?); {advice}") from None
    finally:
        for future in waiting:
            future.cancel()


@contextmanager
def workers(count: int) -> Iterator[Executor]:
    """Start processes that share the machine's cores."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    threads = max(1, cores // count)
    with ProcessPoolExecutor(count, multiprocessing.get_context("spawn"), _begin, (threads,)) as pool:
        yield pool


def _begin(threads: int) -> None:
    import cv2

    from synth.camera.render import start

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer
    cv2.setNumThreads(threads)
    start(threads)


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Connect to the workers of a Dask cluster, best started with --nthreads 1.

    Raises SynthError if none answers.
    """
    from distributed import Client

    try:
        client: Any = Client(address, timeout="10s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise SynthError(f"--scheduler {address}: no Dask scheduler answers there: {reason}") from None
    with client, client.get_executor(pure=False) as executor:
        yield executor


def _shard_file(out: Path, index: int) -> Path:
    return out / "shards" / f"{index:05d}.json"


def _manifest(order: Order, model: WeldModel, variant: str) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "seed": order.seed,
        "count": order.count,
        "shares": crop_fractions(),
        "crops": "flat" if order.is_straight else "arcs",
        "heights": order.has_heights,
        "switches": sorted(order.switches),
        "recipe": order.recipe.tables(),
        "measurement_sha256": model.sha256,
        "renderer": variant,
    }


def _finish(out: Path, shards: list[Shard], manifest: dict[str, Any]) -> None:
    """Write what describes the whole dataset, once all shards are made."""
    images = [entry for shard in shards for entry in json.loads(_shard_file(out, shard.index).read_text())]
    images.sort(key=lambda entry: str(entry["file"])[-10:])
    for split in ("train", "val"):
        entries = [entry for entry in images if f"images/{split}/" in entry["file"]]
        write_text(out / f"coco_{split}.json", json.dumps(_coco(entries)))
        for kind in CROP_KINDS:
            (out / "images" / split / kind).mkdir(parents=True, exist_ok=True)
    names = "".join(f"  {number}: {name}\n" for number, name in enumerate(DETECTED))
    write_text(out / "data.yaml", f"train: images/train\nval: images/val\nnames:\n{names}")
    write_text(out / "manifest.json", json.dumps({**manifest, "images": images}, indent=1))


def _coco(entries: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the annotations as COCO's tools read them; categories are numbered from 1."""
    images: list[dict[str, Any]] = []
    annotations: list[dict[str, Any]] = []
    for number, entry in enumerate(entries, 1):
        images.append({"id": number, "file_name": entry["file"], "width": CROP_PX, "height": CROP_PX})
        for defect in entry["defects"]:
            annotations.append(
                {
                    "id": len(annotations) + 1,
                    "image_id": number,
                    "category_id": DETECTED.index(defect["kind"]) + 1,
                    "bbox": defect["box_px"],
                    "area": defect["area_px"],
                    "segmentation": defect["polygon_px"],
                    "iscrowd": 0,
                }
            )
    categories = [{"id": i, "name": name, "supercategory": "defect"} for i, name in enumerate(DETECTED, 1)]
    return {
        "info": {"description": "rendered welds"},
        "images": images,
        "annotations": annotations,
        "categories": categories,
    }

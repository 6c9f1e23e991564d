"""Datasets of labelled crops on disk, made by many workers, resumable.

DIR/manifest.json                    recipe, switches, seed, hashes: what is needed to make it again
DIR/images/{train,val}/{ok,hole,missing_weld}/NNNNNN.png    class folders (ultralytics classify, anomalib Folder)
DIR/labels/…/NNNNNN.txt              detection labels beside them (ultralytics detect, with DIR/data.yaml)
DIR/masks/…/NNNNNN.png               255 where a defect is (anomalib)
DIR/heights/…/NNNNNN.tif             on request: float32, um
DIR/coco_train.json, coco_val.json   boxes and polygons (COCO)
DIR/shards/NNNNN.json                one per finished shard: written last, so that a killed run goes on with the next
"""

import json
import multiprocessing
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from synth.camera.picture import CROP_PX
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.plan import KINDS, Shard, plan_arcs, plan_flat, quotas
from synth.output.shard import DETECTED, Job, Made, make
from synth.output.storage import claim, write_bytes, write_text
from synth.part.recipe import Recipe
from synth.part.switches import Switch

FORMAT = 1
SHARES = (0.5, 0.25, 0.25)


@dataclass(frozen=True, slots=True)
class Order:
    """What is to be made."""

    seed: int
    count: int
    recipe: Recipe
    switches: frozenset[Switch]
    flat: bool = False
    heights: bool = False
    shares: tuple[float, float, float] = SHARES


def write_dataset(out: Path, order: Order, model: WeldModel, executor: Executor | None, done: Callable[[int], None]) -> None:
    """Make a dataset, or what is missing of it. `done` is called with the number of images of each finished shard.

    Without an executor all is done in this process. Raises SynthError if `out` holds another dataset, a file cannot be written or a
    worker dies; what is finished stays and is not made again.
    """
    from synth.camera.render import start

    variant = start()
    wanted = quotas(order.count, order.shares)
    shards = (plan_flat if order.flat else plan_arcs)(order.seed, wanted, order.recipe, order.switches)
    manifest = _manifest(order, model, variant)
    claim(out / "order.json", manifest)
    left = []
    for shard in shards:
        if _shard_file(out, shard.index).exists():
            done(len(shard.crops))
        else:
            left.append(Job(shard, model, order.heights))
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
        raise SynthError("a worker was killed (out of memory?); run the command again to go on, with fewer --workers if need be") from None
    finally:
        for future in waiting:
            future.cancel()


@contextmanager
def workers(count: int) -> Iterator[Executor]:
    """Processes that share the machine's cores."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    with ProcessPoolExecutor(count, multiprocessing.get_context("spawn"), _begin, (max(1, cores // count),)) as pool:
        yield pool


def _begin(threads: int) -> None:
    import cv2

    from synth.camera.render import start

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer
    cv2.setNumThreads(threads)
    start(threads)


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Workers of a Dask cluster, best started with --nthreads 1. Raises SynthError if none answers."""
    from distributed import Client

    try:
        client: Any = Client(address, timeout="10s")  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise SynthError(f"--scheduler {address}: no Dask scheduler answers there: {str(error).splitlines()[0]}") from None
    with client, client.get_executor(pure=False) as executor:
        yield executor


def _shard_file(out: Path, index: int) -> Path:
    return out / "shards" / f"{index:05d}.json"


def _manifest(order: Order, model: WeldModel, variant: str) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "seed": order.seed,
        "count": order.count,
        "shares": dict(zip(KINDS, order.shares, strict=True)),
        "crops": "flat" if order.flat else "arcs",
        "heights": order.heights,
        "switches": sorted(order.switches),
        "recipe": asdict(order.recipe),
        "measurement_sha256": model.sha256,
        "renderer": variant,
    }


def _finish(out: Path, shards: list[Shard], manifest: dict[str, Any]) -> None:
    images = [entry for shard in shards for entry in json.loads(_shard_file(out, shard.index).read_text())]
    images.sort(key=lambda entry: str(entry["file"])[-10:])
    for split in ("train", "val"):
        write_text(out / f"coco_{split}.json", json.dumps(_coco([e for e in images if f"images/{split}/" in e["file"]])))
        for kind in KINDS:
            (out / "images" / split / kind).mkdir(parents=True, exist_ok=True)
    names = "".join(f"  {i}: {name}\n" for i, name in enumerate(DETECTED))
    write_text(out / "data.yaml", f"path: .\ntrain: images/train\nval: images/val\nnames:\n{names}")
    write_text(out / "manifest.json", json.dumps({**manifest, "images": images}, indent=1))


def _coco(entries: list[dict[str, Any]]) -> dict[str, Any]:
    """Annotations as COCO's tools read them; categories are numbered from 1."""
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
    return {"info": {"description": "rendered welds"}, "images": images, "annotations": annotations, "categories": categories}

"""Datasets: the plan, the files, the labels that other tools read, and what a killed run leaves."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from station.classify.crop_label import OK
from station.defects import KINDS
from station.domain import SEGMENT_DEG
from synth.defects.hole import Hole
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.dataset import Order, workers, write_dataset
from synth.output.plan import CROP_KINDS, RING_ERROR_DEG, plan_pieces, plan_rings, quotas, sure_kind
from synth.output.shard import run_lengths
from synth.part.part import draw_part
from synth.part.switches import ALL
from synth.recipes.named import PAPER, WIDE
from tests.conftest import ROOT

MAPPED = tuple(kind.name for kind in KINDS if kind.is_mapped)
"""Kinds of defect that labels outline, in the order of their numbers."""


def order(count: int, flat: bool = True, seed: int = 3, heights: bool = False) -> Order:
    recipe = PAPER if flat else WIDE
    return Order(seed=seed, count=count, recipe=recipe, switches=ALL, is_straight=flat, has_heights=heights)


def holes() -> tuple[Hole, ...]:
    rng = np.random.default_rng(0)
    found = WIDE.defects["hole"].draw(rng, WIDE.bead.draw(rng))
    assert all(isinstance(hole, Hole) for hole in found)
    return found  # type: ignore[return-value]


def tree(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@given(st.integers(1, 400), st.integers(0, 10**6))
@settings(max_examples=25)
def test_the_plan_holds_exactly_what_is_ordered(count: int, seed: int) -> None:
    wanted = quotas(count)
    assert sum(wanted.values()) == count
    for shards in (plan_pieces(seed, wanted, PAPER, ALL), plan_rings(seed, wanted, WIDE, ALL)):
        crops = [crop for shard in shards for crop in shard.crops]
        assert sorted(crop.number for crop in crops) == list(range(count))
        assert {kind: sum(c.kind == kind for c in crops) for kind in CROP_KINDS} == wanted


def test_the_default_is_the_papers_half_ok_and_the_rest_alike() -> None:
    each = 2500 // len(KINDS)
    assert quotas(5000) == {OK: 5000 - each * len(KINDS), **{kind.name: each for kind in KINDS}}


@given(st.floats(0, 360), st.floats(0.2, 1.2), st.integers(0, 20))
def test_a_crop_is_used_only_if_a_small_error_of_the_ring_leaves_its_kind(
    at: float, length: float, segment: int
) -> None:
    hole = replace(holes()[0], angle_deg=at, length_mm=length)
    part = draw_part(1, WIDE, defects=(hole,))
    start, end = segment * SEGMENT_DEG, (segment + 1) * SEGMENT_DEG
    first, last = hole.span_deg(part.bead)
    middle = (first + last) / 2
    away = abs((middle - (start + end) / 2 + 180) % 360 - 180)
    kind = sure_kind(part, start, end)
    if kind == "hole":
        assert away < (end - start + last - first) / 2
    elif kind == OK:
        assert away > (end - start + last - first) / 2 + RING_ERROR_DEG - 1e-6
    else:
        assert kind is None


def test_a_ring_has_no_hole_where_no_bead_holds_it() -> None:
    ordered = dict.fromkeys(CROP_KINDS, 0) | {OK: 50, "hole": 200, "missing_weld": 200}
    seen = 0
    for shard in plan_rings(5, ordered, WIDE, ALL):
        (part,) = shard.parts
        arcs = [d.span_deg(part.bead) for d in part.defects if d.kind == "missing_weld"]
        for defect in part.defects:
            if defect.kind == "hole":
                middle = sum(defect.span_deg(part.bead)) / 2
                assert all((middle - start) % 360 > end - start for start, end in arcs)
                seen += bool(arcs)
    assert seen > 20


@given(st.integers(1, 6), st.integers(1, 6), st.data())
def test_run_lengths_give_the_mask_back(height: int, width: int, data: st.DataObject) -> None:
    bits = data.draw(st.lists(st.booleans(), min_size=height * width, max_size=height * width))
    mask = np.array(bits, bool).reshape(height, width)
    runs = run_lengths(mask)
    assert runs["size"] == [height, width]
    values = np.repeat(np.arange(len(runs["counts"])) % 2 == 1, runs["counts"])
    assert (values.reshape(width, height).T == mask).all()


@pytest.mark.render
@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # inside pycocotools
def test_files_are_laid_out_for_the_usual_tools(tmp_path: Path, model: WeldModel) -> None:
    from pycocotools.coco import COCO
    from pycocotools.mask import decode, frPyObjects

    write_dataset(tmp_path, order(40, heights=True), model, executor=None, done=lambda n: None)
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    assert len(manifest["images"]) == 40
    for entry in manifest["images"]:
        image = cv2.imread(str(tmp_path / entry["file"]), cv2.IMREAD_UNCHANGED)
        assert image.shape == (128, 128)
        assert image.dtype == np.uint8
        stem = entry["file"].removeprefix("images/").removesuffix(".png")
        assert Path(stem).parent.name == entry["kind"]
        height = cv2.imread(str(tmp_path / f"heights/{stem}.tif"), cv2.IMREAD_UNCHANGED)
        assert height.dtype == np.float32
        assert -500 < height.min() <= height.max() < 200
        lines = (tmp_path / f"labels/{stem}.txt").read_text().splitlines()
        assert len(lines) == len(entry["defects"])
        assert bool(lines) == (entry["kind"] in MAPPED)
        if not lines:
            continue
        shown = cv2.imread(str(tmp_path / f"masks/{stem}.png"), cv2.IMREAD_UNCHANGED) > 0
        if entry["kind"] in ("hole", "missing_weld"):
            assert height[shown].mean() < -300  # beneath the weld lies the floor
        for line, defect in zip(lines, entry["defects"], strict=True):
            label, x, y, w, h = (float(v) for v in line.split())
            assert MAPPED[int(label)] == defect["kind"] == entry["kind"]
            exact = decode(frPyObjects(defect["rle"], 128, 128)) > 0
            assert exact.sum() == defect["area_px"]
            assert not (exact & ~shown).any()
            left, top, width, height_px = defect["box_px"]
            assert [x * 128, y * 128, w * 128, h * 128] == pytest.approx(
                [left + width / 2, top + height_px / 2, width, height_px], abs=1e-3
            )
    for split in ("train", "val"):
        annotated = COCO(str(tmp_path / f"coco_{split}.json"))
        assert {c["name"] for c in annotated.loadCats(annotated.getCatIds())} == set(MAPPED)
        for annotation in annotated.loadAnns(annotated.getAnnIds()):
            drawn = annotated.annToMask(annotation)
            borders = [np.reshape(line, (-1, 1, 2)).astype(np.float32) for line in annotation["segmentation"]]
            border_px = sum(cv2.arcLength(border, True) for border in borders)  # most of a thin kind's pixels
            assert drawn.sum() == pytest.approx(annotation["area"], rel=0.35, abs=max(30, border_px))
    assert (tmp_path / "data.yaml").read_text().count("images/") == 2
    assert "path" not in (tmp_path / "data.yaml").read_text(), "it counts from the folder of the file"


@pytest.mark.render
@pytest.mark.parametrize("flat", [True, False])
def test_same_seed_same_bytes_on_one_and_two_workers(flat: bool, tmp_path: Path, model: WeldModel) -> None:
    count = 60 if flat else 30
    write_dataset(tmp_path / "here", order(count, flat), model, executor=None, done=lambda n: None)
    with workers(2) as pool:
        write_dataset(tmp_path / "two", order(count, flat), model, executor=pool, done=lambda n: None)
    assert tree(tmp_path / "here") == tree(tmp_path / "two")
    for entry in json.loads((tmp_path / "here" / "manifest.json").read_text())["images"]:
        assert bool(entry["defects"]) == (entry["kind"] != "ok")
        assert (entry["segment"] is None) == flat


@pytest.mark.render
def test_what_is_finished_is_not_made_again(tmp_path: Path, model: WeldModel) -> None:
    write_dataset(tmp_path / "whole", order(50), model, executor=None, done=lambda n: None)
    whole = tree(tmp_path / "whole")
    again = tmp_path / "again"
    shutil.copytree(tmp_path / "whole", again)
    (again / "shards" / "00001.json").unlink()
    for entry in json.loads((tmp_path / "whole" / "shards" / "00001.json").read_text())[::2]:
        (again / entry["file"]).unlink()
    seen: list[int] = []
    write_dataset(again, order(50), model, executor=None, done=seen.append)
    assert sorted(seen) == [2, 24, 24]
    assert tree(again) == whole
    with pytest.raises(SynthError, match=r"begun with another seed; name an empty folder"):
        write_dataset(again, order(50, seed=4), model, executor=None, done=lambda n: None)


def command(out: Path, *more: str) -> list[str]:
    return [
        sys.executable,
        "-m",
        "synth",
        "dataset",
        "--flat",
        "--base",
        "paper",
        "--workers",
        "2",
        "--out",
        str(out),
        *more,
    ]


@pytest.mark.render
def test_a_killed_worker_is_said_and_the_run_goes_on(tmp_path: Path) -> None:
    out = tmp_path / "set"
    run = subprocess.Popen(command(out, "--count", "400"), cwd=ROOT, stderr=subprocess.PIPE, text=True)
    while not list((out / "shards").glob("*.json")):
        assert run.poll() is None
        time.sleep(0.05)
    children = Path(f"/proc/{run.pid}/task").glob("*/children")
    pids = [int(pid) for path in children for pid in path.read_text().split()]
    worker = next(pid for pid in pids if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes())
    os.kill(worker, signal.SIGKILL)
    _, said = run.communicate(timeout=600)
    assert run.returncode == 2
    assert "a worker was killed" in said
    assert "Traceback" not in said
    done = len(list((out / "shards").glob("*.json")))
    assert 0 < done < 17
    assert not list(out.rglob("*.part"))
    assert not (out / "manifest.json").exists()


@pytest.mark.render
def test_a_full_disk_is_said_and_leaves_no_half_image(tmp_path: Path) -> None:
    code = "import resource, sys, signal\n"
    options = ["part", "--ring-only", "--count", "1", "--out", str(tmp_path)]
    code += "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\n"
    code += "resource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))\n"
    code += f"from synth.__main__ import main\nsys.exit(main({options!r}))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 2
    assert "could not be written: File too large" in done.stderr
    assert not list(tmp_path.rglob("*.png"))
    assert not list(tmp_path.rglob("*.part"))

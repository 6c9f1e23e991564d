"""Datasets: the plan, the files, the labels that other tools read, and what a killed run leaves."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.labelled import Defect, crop_label
from station.classify.onnx import CLASSES
from station.domain import SEGMENTS
from synth.errors import SynthError
from synth.measured.spectrum import WeldModel
from synth.output.dataset import Order, workers, write_dataset
from synth.output.plan import KINDS, crop_kind, plan_arcs, plan_flat, quotas
from synth.part.part import Hole, MissingWeld, Truth, draw_part
from synth.part.recipe import PAPER, WIDE
from synth.part.switches import ALL
from tests.conftest import ROOT


def order(count: int, flat: bool = True, seed: int = 3, heights: bool = False) -> Order:
    return Order(seed, count, PAPER if flat else WIDE, ALL, flat, heights)


def tree(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@given(st.integers(1, 400), st.integers(0, 10**6))
@settings(max_examples=25, deadline=None)
def test_the_plan_holds_exactly_what_is_ordered(count: int, seed: int) -> None:
    wanted = quotas(count, (0.5, 0.25, 0.25))
    assert sum(wanted.values()) == count
    for shards in (plan_flat(seed, wanted, PAPER, ALL), plan_arcs(seed, wanted, WIDE, ALL)):
        crops = [crop for shard in shards for crop in shard.crops]
        assert sorted(crop.number for crop in crops) == list(range(count))
        assert {kind: sum(c.kind == kind for c in crops) for kind in KINDS} == wanted


def test_the_default_is_the_papers() -> None:
    assert quotas(5000, (0.5, 0.25, 0.25)) == {"ok": 2500, "hole": 1250, "missing_weld": 1250}


@given(
    st.lists(st.tuples(st.floats(0, 360), st.floats(0.1, 2.4)), max_size=6),
    st.lists(st.tuples(st.floats(0, 360), st.floats(5, 200)), max_size=2),
    st.integers(0, SEGMENTS - 1),
)
def test_a_crop_is_called_what_the_learning_calls_it(
    holes: list[tuple[float, float]], arcs: list[tuple[float, float]], segment: int
) -> None:
    part = draw_part(
        1,
        Truth.OK,
        WIDE,
        defects=(tuple(Hole(at, 0, length, 0.2, 0, 3, 2) for at, length in holes), tuple(MissingWeld(at, at + span) for at, span in arcs)),
    )
    half = [np.rad2deg(length / part.radius_mm) / 2 for _, length in holes]
    defects = [Defect(CLASSES.index("hole"), at - h, at + h) for (at, _), h in zip(holes, half, strict=True)]
    defects += [Defect(CLASSES.index("missing_weld"), at, at + span) for at, span in arcs]
    start, end = segment * 360 / SEGMENTS, (segment + 1) * 360 / SEGMENTS
    kind = crop_kind(part, start, end)
    assert {None: -1, "ok": 0, "hole": 1, "missing_weld": 2}[kind] == crop_label(tuple(defects), start, end)


@pytest.mark.render
@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # inside pycocotools
def test_files_are_laid_out_for_the_usual_tools(tmp_path: Path, model: WeldModel) -> None:
    from pycocotools.coco import COCO

    write_dataset(tmp_path, order(40, heights=True), model, None, lambda n: None)
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
        assert bool(lines) == (entry["kind"] != "ok")
        if entry["kind"] == "ok":
            continue
        shown = cv2.imread(str(tmp_path / f"masks/{stem}.png"), cv2.IMREAD_UNCHANGED) > 0
        assert height[shown].mean() < -300  # beneath the weld lies the floor
        for line, defect in zip(lines, entry["defects"], strict=True):
            label, x, y, w, h = (float(v) for v in line.split())
            assert ("hole", "missing_weld")[int(label)] == defect["kind"] == entry["kind"]
            left, top, width, height_px = defect["box_px"]
            assert [x * 128, y * 128, w * 128, h * 128] == pytest.approx(
                [left + width / 2, top + height_px / 2, width, height_px], abs=1e-3
            )
    for split in ("train", "val"):
        annotated = COCO(str(tmp_path / f"coco_{split}.json"))
        assert {c["name"] for c in annotated.loadCats(annotated.getCatIds())} == {"hole", "missing_weld"}
        for annotation in annotated.loadAnns(annotated.getAnnIds()):
            drawn = annotated.annToMask(annotation)
            assert drawn.sum() == pytest.approx(annotation["area"], rel=0.35, abs=30)
    assert (tmp_path / "data.yaml").read_text().count("images/") == 2


@pytest.mark.render
@pytest.mark.parametrize("flat", [True, False])
def test_same_seed_same_bytes_on_one_and_two_workers_and_a_cluster(flat: bool, tmp_path: Path, model: WeldModel) -> None:
    count = 60 if flat else 30
    write_dataset(tmp_path / "here", order(count, flat), model, None, lambda n: None)
    with workers(2) as pool:
        write_dataset(tmp_path / "two", order(count, flat), model, pool, lambda n: None)
    assert tree(tmp_path / "here") == tree(tmp_path / "two")
    for entry in json.loads((tmp_path / "here" / "manifest.json").read_text())["images"]:
        assert bool(entry["defects"]) == (entry["kind"] != "ok")
        assert (entry["segment"] is None) == flat


@pytest.mark.render
def test_what_is_finished_is_not_made_again(tmp_path: Path, model: WeldModel) -> None:
    write_dataset(tmp_path / "whole", order(50), model, None, lambda n: None)
    whole = tree(tmp_path / "whole")
    again = tmp_path / "again"
    write_dataset(again, order(50), model, None, lambda n: None)
    (again / "shards" / "00001.json").unlink()
    for entry in json.loads((tmp_path / "whole" / "shards" / "00001.json").read_text())[::2]:
        (again / entry["file"]).unlink()
    seen: list[int] = []
    write_dataset(again, order(50), model, None, seen.append)
    assert sorted(seen) == [2, 24, 24]
    assert tree(again) == whole
    with pytest.raises(SynthError, match=r"begun with another seed; name an empty folder"):
        write_dataset(again, order(50, seed=4), model, None, lambda n: None)


def command(out: Path, *more: str) -> list[str]:
    return [sys.executable, "-m", "synth", "dataset", "--flat", "--base", "paper", "--workers", "2", "--out", str(out), *more]


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
    _, said = run.communicate(timeout=60)
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
    code += "signal.signal(signal.SIGXFSZ, signal.SIG_IGN)\nresource.setrlimit(resource.RLIMIT_FSIZE, (4000, 4000))\n"
    code += f"from synth.__main__ import main\nsys.exit(main(['part', '--ring-only', '--count', '1', '--out', {str(tmp_path)!r}]))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=100, check=False)
    assert done.returncode == 2
    assert "could not be written: File too large" in done.stderr
    assert not list(tmp_path.rglob("*.png"))
    assert not list(tmp_path.rglob("*.part"))

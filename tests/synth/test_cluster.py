"""The same bytes from a Dask cluster, in a process of its own: a real scheduler and worker on loopback."""

import subprocess
import sys
from pathlib import Path

import pytest

from synth.measured.spectrum import WeldModel
from synth.output.dataset import Order, write_dataset
from synth.part.switches import ALL
from synth.recipes.named import PAPER
from tests.conftest import ROOT

CODE = """
import sys
from distributed import LocalCluster
from synth.__main__ import main
if __name__ == "__main__":
    with LocalCluster(n_workers=1, threads_per_worker=1, host="127.0.0.1", dashboard_address=None) as cluster:
        options = ["--flat", "--base", "paper", "--seed", "3", "--count", "30", "--out", sys.argv[1]]
        sys.exit(main(["dataset", *options, "--scheduler", cluster.scheduler_address]))
"""


@pytest.mark.render
def test_same_bytes_from_a_cluster(tmp_path: Path, model: WeldModel) -> None:
    script = tmp_path / "run.py"
    script.write_text(CODE)
    out = tmp_path / "cluster"
    done = subprocess.run(
        [sys.executable, str(script), str(out)],
        cwd=ROOT,
        env={"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    order = Order(seed=3, count=30, recipe=PAPER, switches=ALL, is_straight=True)
    write_dataset(tmp_path / "here", order, model, executor=None, done=lambda n: None)
    for path in (tmp_path / "here").rglob("*.*"):
        assert path.read_bytes() == (out / path.relative_to(tmp_path / "here")).read_bytes(), path


def test_no_scheduler_there_is_said(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "synth",
        "dataset",
        "--count",
        "1",
        "--out",
        str(tmp_path),
        "--scheduler",
        "tcp://127.0.0.1:1",
    ]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=600, check=False)
    assert done.returncode == 2
    assert "--scheduler tcp://127.0.0.1:1: no Dask scheduler answers there" in done.stderr
    assert "Traceback" not in done.stderr

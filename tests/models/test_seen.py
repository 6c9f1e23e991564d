"""The network that says what is hidden: its covers, samples, training and file."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from models.__main__ import main
from models.errors import LearningError
from models.seen.covers import COVERS, cover
from models.seen.network import COLUMNS
from models.seen.samples import Strips, read_strips, sample
from models.seen.train import SeenPlan, train_seen
from station.classify.onnx import SeenNetwork
from station.domain import STRIP_COLUMNS, STRIP_ROWS
from station.errors import ModelError

SHIPPED = Path(__file__).parents[2] / "models" / "shipped"


def _ring_frame(rng: np.random.Generator) -> NDArray[np.uint8]:
    """Return a bright, rippled ring of radius 428 px on a darker, grainy sheet, (1280, 1280) uint8."""
    rows, columns = np.indices((1280, 1280), np.float32)
    away = np.abs(np.hypot(columns - 640, rows - 640) - 428)
    angle = np.arctan2(rows - 640, columns - 640)
    picture = 80 + rng.normal(0, 6, away.shape)
    picture[away < 38] = (150 + 40 * np.sin(angle * 250))[away < 38]
    return np.asarray(np.clip(picture, 0, 255), np.uint8)


def _lot(folder: Path, count: int = 2) -> Path:
    (folder / "frames").mkdir(parents=True)
    entries = []
    for number in range(count):
        name = f"part_{number}.png"
        cv2.imwrite(str(folder / "frames" / name), _ring_frame(np.random.default_rng(number)))
        entries.append({"frame": name, "center": [640, 640], "radius": 428, "verdict": "OK", "defects": []})
    (folder / "labels.json").write_text(json.dumps({"frames": entries}))
    return folder


@given(name=st.sampled_from(sorted(COVERS)), seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=60)
def test_a_cover_changes_what_it_hides(name: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    crop, spare = (rng.uniform(0, 255, (128, 128)).astype(np.float32) for _ in range(2))

    seen, hidden = cover(np.random.default_rng(seed), crop, spare, (name,))

    assert seen.dtype == hidden.dtype == np.float32
    assert np.isfinite(seen).all()
    assert (hidden >= 0).all()
    assert (hidden <= 1).all()
    whole = hidden > 0.9
    if whole.sum() > 500:
        assert np.abs(seen - crop)[whole].mean() > 1


@given(seed=st.integers(0, 10_000))
@settings(deadline=None, max_examples=40)
def test_what_is_hidden_is_a_fraction_of_each_column(seed: int) -> None:
    rng = np.random.default_rng(seed)
    strip = rng.integers(0, 256, (STRIP_ROWS, STRIP_COLUMNS), dtype=np.uint8)
    is_weld = np.zeros_like(strip)
    is_weld[30:98] = 1

    drawn = sample([Strips(strip, is_weld, (strip,))], tuple(COVERS), rng)

    assert drawn.crop.shape == (128, 128)
    assert drawn.crop.dtype == np.uint8
    assert drawn.hidden.shape == (COLUMNS,)
    assert ((drawn.hidden >= 0) & (drawn.hidden <= 1 + 1e-6)).all()
    assert drawn.covered.shape == (COLUMNS, COLUMNS)


def test_strips_are_cut_where_the_labels_say(tmp_path: Path) -> None:
    strips = read_strips(_lot(tmp_path / "lot"), np.random.default_rng(0))

    assert len(strips) == 2
    for part in strips:
        assert part.weld[50:78].mean() > part.beside[0].mean() + 30
        assert part.is_weld[50:78].all()
        assert not part.is_weld[:10].any()


def test_a_short_training_learns_to_tell_a_weld_from_its_sheet(tmp_path: Path) -> None:
    lot, out = _lot(tmp_path / "lot", 9), tmp_path / "out"

    assert main(["train-seen", str(lot), "--out", str(out), "--version", "0", "--steps", "60"]) == 0

    strips = read_strips(lot, np.random.default_rng(1))
    network = SeenNetwork(out / "seen.onnx")
    weld = np.stack([part.weld[:, :128] for part in strips])
    beside = np.stack([part.beside[0][:, :128] for part in strips])
    assert network(beside).mean() > network(weld).mean() + 0.2
    assert "leave_out" in (out / "SEEN.md").read_text()


def test_an_unknown_cover_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LearningError, match="unknown cover fog; known: flat"):
        train_seen([_lot(tmp_path / "lot", 1)], SeenPlan(leave_out=("fog",)), print)


def test_another_network_is_not_taken_for_one_that_says_what_is_hidden() -> None:
    with pytest.raises(ModelError, match="train-seen"):
        SeenNetwork(SHIPPED / "weldgate.onnx")

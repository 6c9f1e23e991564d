import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from models.data.crops import OK
from models.data.rendered import read_rendered
from models.errors import LearningError
from tests.models.made import HOLE, MISSING, dataset


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return dataset(tmp_path / "data")


def test_a_dataset_is_read_whole_and_its_maps_lie_on_the_defects(folder: Path) -> None:
    training, held, digest = read_rendered([folder])
    assert (len(training), len(held)) == (24, 12)
    assert [training.count(k) for k in (OK, HOLE, MISSING)] == [8, 8, 8]
    assert len(digest) == 64
    for image, label, maps in zip(training.images, training.labels, training.maps, strict=True):
        assert bool(maps.any()) == (label != OK)
        if label != OK:
            covered = np.kron(maps[label - 1], np.ones((4, 4))) == 255
            assert image[covered].mean() < 30
            assert not maps[2 - label].any()


def test_two_datasets_are_one(folder: Path, tmp_path: Path) -> None:
    other = dataset(tmp_path / "other", 18)
    assert len(read_rendered([folder, other])[0]) == 24 + 12


def _remove(folder: Path, name: str) -> None:
    (folder / name).unlink()


def _garble(folder: Path, name: str) -> None:
    (folder / name).write_bytes(b"not a picture")


def _resize(folder: Path, name: str) -> None:
    cv2.imwrite(str(folder / name), np.zeros((64, 128), np.uint8))


def _alter(folder: Path, name: str) -> None:
    cv2.imwrite(str(folder / name), np.zeros((128, 128), np.uint8))


def _stray(folder: Path, _name: str) -> None:
    (folder / "images/train/ok/stray.png").write_bytes(b"x")


def _misname(folder: Path, name: str) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    next(e for e in manifest["images"] if e["file"] == name)["kind"] = "hole"
    (folder / "manifest.json").write_text(json.dumps(manifest))


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (_remove, "000000.png: missing"),
        (_garble, "000000.png: not a readable image"),
        (_resize, "000000.png: 128 x 64 px uint8, needed 128 x 128 px"),
        (_alter, "000000.png: differs from the manifest"),
        (_stray, "stray.png: not in the manifest"),
        (_misname, "000000.png: the manifest calls it hole"),
    ],
)
def test_what_is_wrong_with_a_dataset_is_listed(spoil, said: str, folder: Path) -> None:  # type: ignore[no-untyped-def]
    spoil(folder, "images/train/ok/000000.png")
    with pytest.raises(LearningError, match=said):
        read_rendered([folder])


def test_all_that_is_wrong_is_named_at_once(folder: Path) -> None:
    _remove(folder, "images/train/ok/000000.png")
    _remove(folder, "images/train/hole/000001.png")
    with pytest.raises(LearningError, match=r"2 wrong.*000000\.png.*000001\.png"):
        read_rendered([folder])


def test_a_folder_that_is_no_dataset_says_how_to_make_one(tmp_path: Path) -> None:
    with pytest.raises(LearningError, match="weldgate-synth dataset"):
        read_rendered([tmp_path])


def test_a_dataset_without_one_kind_is_refused(tmp_path: Path) -> None:
    folder = dataset(tmp_path / "data")
    manifest = json.loads((folder / "manifest.json").read_text())
    for entry in [e for e in manifest["images"] if e["kind"] == "missing_weld" and "/val/" in e["file"]]:
        (folder / entry["file"]).unlink()
        manifest["images"].remove(entry)
    (folder / "manifest.json").write_text(json.dumps(manifest))
    with pytest.raises(LearningError, match="images/val shows no missing_weld"):
        read_rendered([folder])

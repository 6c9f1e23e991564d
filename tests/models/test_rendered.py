import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from models.data.crops import CHANNELS, DEFECTS, OK
from models.data.rendered import read_rendered
from models.errors import LearningError
from station.classify.onnx import CLASSES
from tests.models.made import HOLE, MISSING, dataset


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return dataset(tmp_path / "data")


def test_a_dataset_is_read_whole_and_its_maps_lie_on_the_defects(folder: Path) -> None:
    training, held, digest = read_rendered([folder])
    assert (len(training), len(held)) == (24, 12)
    assert [training.count(label) for label in (OK, *DEFECTS)] == [24 // len(CLASSES)] * len(CLASSES)
    assert len(digest) == 64
    for image, label, maps in zip(training.images, training.labels, training.maps, strict=True):
        assert bool(maps.any()) == (label != OK)
        if label != OK:
            channel = CHANNELS.index(CLASSES[label])
            covered = np.kron(maps[channel], np.ones((4, 4))) == 255
            assert image[covered].mean() < 30
            assert not np.delete(maps, channel, axis=0).any()


def test_two_datasets_are_one(folder: Path, tmp_path: Path) -> None:
    other = dataset(tmp_path / "other", 18)
    assert len(read_rendered([folder, other])[0]) == 24 + 12


def _remove(folder: Path, name: str) -> None:
    (folder / name).unlink()


def _garble(folder: Path, name: str) -> None:
    (folder / name).write_bytes(b"not an image")


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
    ("spoil", "problem"),
    [
        (_remove, "000000.png: missing"),
        (_garble, "000000.png: not a readable image"),
        (_resize, "000000.png: 128 x 64 px uint8, needed 128 x 128 px"),
        (_alter, "000000.png: differs from the manifest"),
        (_stray, "stray.png: not in the manifest"),
        (_misname, "000000.png: the manifest calls it hole"),
    ],
)
def test_what_is_wrong_with_a_dataset_is_listed(spoil, problem: str, folder: Path) -> None:  # type: ignore[no-untyped-def]
    spoil(folder, "images/train/ok/000000.png")
    with pytest.raises(LearningError, match=problem):
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


def test_a_kind_that_is_not_asked_for_may_be_absent(tmp_path: Path) -> None:
    folder = dataset(tmp_path / "data", kinds=("ok", "hole"))
    assert read_rendered([folder], [HOLE])[0].count(HOLE) == 12
    assert read_rendered([folder], ())[1].count(MISSING) == 0
    with pytest.raises(LearningError, match=r"images/train shows no missing_weld\. Render more crops"):
        read_rendered([folder], [HOLE, MISSING])
    with pytest.raises(LearningError, match=r"images/train shows no defect\. "):
        read_rendered([dataset(tmp_path / "good", kinds=("ok",))], ())


def _outlines(folder: Path, kind: str, outlines: object) -> None:
    manifest = json.loads((folder / "manifest.json").read_text())
    for entry in manifest["images"]:
        if entry["kind"] == kind:
            entry["defects"] = outlines
    (folder / "manifest.json").write_text(json.dumps(manifest))


def test_a_kind_that_is_never_outlined_is_refused(folder: Path) -> None:
    _outlines(folder, "hole", [])
    with pytest.raises(LearningError, match=r"images/train outlines none of its \d+ crops of hole"):
        read_rendered([folder])


def test_an_outline_of_an_unknown_kind_is_refused(folder: Path) -> None:
    _outlines(folder, "hole", [{"kind": "dent", "polygon_px": [[1, 1, 9, 1, 9, 9]]}])
    with pytest.raises(LearningError, match="outline of unknown kind dent"):
        read_rendered([folder])

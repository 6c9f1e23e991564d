"""What a folder of data is."""

from pathlib import Path

import pytest

from models.__main__ import main
from models.data.folder import FolderKind, folder_kind
from models.errors import LearningError
from tests.models.made import dataset


def lot(folder: Path) -> Path:
    (folder / "frames").mkdir(parents=True)
    (folder / "labels.json").write_text("{}")
    return folder


def test_a_lot_and_a_dataset_are_told_apart(tmp_path: Path) -> None:
    assert folder_kind(lot(tmp_path / "lot")) is FolderKind.LOT
    assert folder_kind(dataset(tmp_path / "data", 9)) is FolderKind.DATASET


def test_a_rendered_lot_with_its_manifest_is_a_lot(tmp_path: Path) -> None:
    (lot(tmp_path) / "manifest.json").write_text("{}")
    assert folder_kind(tmp_path) is FolderKind.LOT


def test_an_unfinished_lot_is_neither(tmp_path: Path) -> None:
    (tmp_path / "frames").mkdir()
    (tmp_path / "manifest.json").write_text("{}")
    with pytest.raises(LearningError, match=r": neither a lot nor a dataset \(.*\)\. Name a folder made by"):
        folder_kind(tmp_path)


def test_a_folder_with_both_is_refused(tmp_path: Path) -> None:
    with pytest.raises(LearningError, match=r": both a lot and a dataset \(.*\)\. Move one of them"):
        folder_kind(lot(dataset(tmp_path / "data", 9) / ".." / "data"))


def test_a_lot_is_not_evaluated_together_with_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["evaluate", str(lot(tmp_path / "lot")), str(dataset(tmp_path / "data", 9))]) == 2
    assert "2 folders, one of them a lot. Name one lot, or only datasets" in capsys.readouterr().err

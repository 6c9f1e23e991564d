"""What a folder of data is: a lot of labelled frames, or a dataset of labelled crops."""

from enum import Enum
from pathlib import Path

from models.errors import LearningError


class FolderKind(Enum):
    """Kind of data in a folder."""

    LOT = "lot"
    """Labelled frames: labels.json and frames/."""
    DATASET = "dataset"
    """Labelled crops: manifest.json and images/."""


def folder_kind(folder: Path) -> FolderKind:
    """Return the kind of data in a folder. Raises LearningError if the folder is neither or both."""
    is_lot = (folder / "labels.json").is_file()
    # a rendered lot has a manifest of its own, next to frames/ instead of images/
    is_dataset = (folder / "manifest.json").is_file() and (folder / "images").is_dir()
    if is_lot and is_dataset:
        files = "labels.json and frames/, manifest.json and images/"
        raise LearningError(
            f"{folder}: both a lot and a dataset ({files}). Move one of them to another folder"
        )
    if not is_lot and not is_dataset:
        files = "no labels.json, no manifest.json with images/"
        hint = "Name a folder made by weldgate-synth part or weldgate-synth dataset"
        raise LearningError(f"{folder}: neither a lot nor a dataset ({files}). {hint}")
    return FolderKind.LOT if is_lot else FolderKind.DATASET

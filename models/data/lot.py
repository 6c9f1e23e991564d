"""Lots: folders of labelled frames (labels.json and frames/), rendered or a line's own."""

import hashlib
import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.data.crops import OK
from models.errors import LearningError, listed
from station.classify.onnx import CLASSES
from station.domain import NETWORK_UM_PER_PX, TRAINED_UM_PER_PX
from station.errors import ImageError
from station.files.image import read_image

LABELS = {name: label for label, name in enumerate(CLASSES) if label != OK}
"""Label of each kind of defect by name."""
OLD_NAMES = {"hole_small": "hole", "hole_long": "hole"}
"""Kinds of defect in lots of earlier versions."""


@dataclass(frozen=True, slots=True)
class Defect:
    """One labelled defect: its arc in degrees, whose end may exceed 360."""

    label: int
    start_deg: float
    end_deg: float
    length_mm: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LabelledFrame:
    """One frame of a lot: the true ring in frame pixels and what the part shows."""

    name: str
    """File name in frames/."""
    center_x_px: float
    center_y_px: float
    radius_px: float
    verdict: str
    """OK or NOK."""
    defects: tuple[Defect, ...]
    um_per_px: float = NETWORK_UM_PER_PX
    """Scale of the frame."""


def read_labels(folder: Path) -> list[LabelledFrame]:
    """Read labels.json.

    Raises LearningError listing every wrong entry and every missing or repeated image.
    """
    path = folder / "labels.json"
    try:
        labels = json.loads(path.read_text(encoding="utf-8"))["frames"]
        named = [(str(item["frame"]), item) for item in labels]
    except FileNotFoundError:
        hint = f"Render a lot first with weldgate-synth part --out {folder}"
        raise LearningError(f"{path}: no such file. {hint}") from None
    except (ValueError, KeyError, TypeError):
        raise LearningError(f"{path}: not a labels file. Make it again, or restore it") from None
    if not named:
        raise LearningError(f"{path}: lists no image. Label some frames")
    wrong, found = [], []
    for name, item in named:
        try:
            found.append(_read(name, item))
        except _Wrong as problem:
            wrong.append(f"{name}: {problem}")
    wrong += [
        f"{name}: the image is missing" for name, _ in named if not (folder / "frames" / name).is_file()
    ]
    times = Counter(name for name, _ in named)
    wrong += [f"{name}: labelled {'twice' if n == 2 else f'{n} times'}" for name, n in times.items() if n > 1]
    if wrong:
        raise LearningError(listed(folder, wrong))
    return found


def frames(
    folder: Path, labels: Sequence[LabelledFrame]
) -> Iterator[tuple[LabelledFrame, NDArray[np.uint8]]]:
    """Yield each label with its image (H, W) uint8, read as the station reads it.

    Raises LearningError at the end, listing every image that is not readable.
    """
    wrong = []
    for label in labels:
        try:
            yield label, read_image(folder / "frames" / label.name)
        except ImageError as error:
            wrong.append(str(error))
    if wrong:
        raise LearningError(listed(folder, wrong))


def data_hash(folders: Sequence[Path]) -> str:
    """Return the SHA-256 over labels, images and masks, if any, of lots, each in the order of their names.

    What else labels.json says, such as how its parts were ordered, does not count.
    """
    digest = hashlib.sha256()
    for folder in folders:
        labels = json.loads((folder / "labels.json").read_text(encoding="utf-8"))["frames"]
        digest.update(json.dumps(labels, sort_keys=True).encode())
        for images in ("frames", "masks"):
            for path in sorted((folder / images).glob("*.png")):
                digest.update(path.read_bytes())
    return digest.hexdigest()


class _Wrong(Exception):
    """What is wrong with one entry of labels.json."""


def _read(name: str, item: dict[str, object]) -> LabelledFrame:
    """Check one entry of labels.json. Raises _Wrong."""
    try:
        return _checked(name, item)
    except (KeyError, ValueError, TypeError) as error:
        raise _Wrong(f"the entry lacks or garbles {error}") from None


def _checked(name: str, item: dict) -> LabelledFrame:  # type: ignore[type-arg] # any JSON
    x, y = item["center"]
    radius = item["radius"]
    if not (float(radius) > 0 and np.isfinite([x, y, radius]).all()):
        raise _Wrong("centre and radius must be numbers")
    low, high = TRAINED_UM_PER_PX
    um_per_px = float(item.get("um_per_px", NETWORK_UM_PER_PX))
    if not low <= um_per_px <= high:
        raise _Wrong(f"um_per_px {um_per_px:g} must be {low:g} to {high:g}")
    defects = tuple(_defect(entry) for entry in item["defects"])
    verdict = item["verdict"]
    if verdict not in ("OK", "NOK") or (verdict == "NOK") != bool(defects):
        raise _Wrong(f"verdict {verdict} does not fit {len(defects)} defects")
    return LabelledFrame(
        name=name,
        center_x_px=float(x),
        center_y_px=float(y),
        radius_px=float(radius),
        verdict=str(verdict),
        defects=defects,
        um_per_px=um_per_px,
    )


def _defect(entry: dict) -> Defect:  # type: ignore[type-arg] # any JSON
    start, end = entry["angle_deg"]
    kind = OLD_NAMES.get(str(entry["kind"]), str(entry["kind"]))
    if kind not in LABELS:
        raise _Wrong(f"unknown kind {entry['kind']}; known: {', '.join(LABELS)}")
    if not 0 <= float(end) - float(start) <= 360:
        raise _Wrong(f"angle_deg {entry['angle_deg']} must be [start, end], end 0 to 360 degrees after start")
    length_mm = entry.get("length_mm")
    return Defect(LABELS[kind], float(start), float(end), None if length_mm is None else float(length_mm))

"""Labelled parts to strips and crops, through the station's own unwrap: rendered lots and a line's own labelled images.

A lot is a folder with `labels.json` (what `weldgate-synth part` writes) and `frames/`. The paper's protocol for real images
(section 3.2): a window that slides by 10 px, kinds balanced by repeating and leaving out, 70/15/15 % by part.
"""

import hashlib
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.data.crops import DEFECTS, IGNORED, OK, Crops, empty_maps
from models.errors import LearningError, listed
from station.classify.crop_label import crop_label
from station.classify.onnx import CLASSES
from station.domain import SEGMENT_DEG, SEGMENT_PX, SEGMENTS, STRIP_COLUMNS, Ring
from station.errors import ImageError, LocateError
from station.files.image import read_image
from station.vision.unwrap import unwrap

WINDOW_STEP_PX = 10
SHARES = (0.70, 0.15, 0.15)
LABELS = {name: label for label, name in enumerate(CLASSES) if label != OK}
OLD_NAMES = {"hole_small": "hole", "hole_long": "hole"}
"""Kinds of defect in lots of earlier versions."""


@dataclass(frozen=True, slots=True)
class Defect:
    """Arc of a defect, degrees, end may exceed 360."""

    label: int
    start_deg: float
    end_deg: float


@dataclass(frozen=True, slots=True, eq=False)
class LabelledStrip:
    """One unwrapped part: strip (128, 2688) uint8 and its defects."""

    part: str
    strip: NDArray[np.uint8]
    defects: tuple[Defect, ...]

    def crop(self, column: int) -> NDArray[np.uint8]:
        """Crop (128, 128) that starts at `column`; wraps round."""
        return self.strip[:, np.arange(column, column + SEGMENT_PX) % STRIP_COLUMNS]

    def crop_label(self, column: int) -> int:
        """Label of the crop that starts at `column`, `IGNORED` included."""
        start = column * 360.0 / STRIP_COLUMNS
        return label_of_arc(self.defects, start, start + SEGMENT_DEG)


def label_of_arc(defects: Sequence[Defect], start_deg: float, end_deg: float) -> int:
    """Return the label of the crop over the arc [start, end]: that of the gravest kind of defect in it, OK or IGNORED."""
    shown = crop_label(((CLASSES[d.label], d.start_deg, d.end_deg) for d in defects), start_deg, end_deg)
    return IGNORED if shown is None else CLASSES.index(shown)


def frames(
    folder: Path, items: Sequence[dict[str, Any]]
) -> Iterator[tuple[dict[str, Any], NDArray[np.uint8]]]:
    """Entries of a lot with their images (H, W) uint8, read as the station reads them.

    Raises LearningError at the end, listing all that are not readable.
    """
    wrong = []
    for item in items:
        try:
            yield item, read_image(folder / "frames" / str(item["frame"]))
        except ImageError as error:
            wrong.append(str(error))
    if wrong:
        raise LearningError(listed(folder, wrong))


def read_lot(folder: Path) -> list[LabelledStrip]:
    """Strips of all parts, cut at the labelled ring. Raises LearningError listing all that is wrong."""
    strips, outside = [], []
    for item, image in frames(folder, read_labels(folder)):
        try:
            strip = unwrap(image, Ring(item["center"][0], item["center"][1], item["radius"], 1.0))
        except LocateError as error:
            outside.append(f"{item['frame']}: {error}; correct its label")
            continue
        strips.append(LabelledStrip(str(item["frame"]), strip, defects_of(item)))
    if outside:
        raise LearningError(listed(folder, outside))
    return strips


def read_images(folder: Path) -> list[tuple[NDArray[np.uint8], float, float, float]]:
    """Images of a lot with the true circle: (image, centre x, centre y, radius), px. Raises LearningError."""
    return [
        (image, float(item["center"][0]), float(item["center"][1]), float(item["radius"]))
        for item, image in frames(folder, read_labels(folder))
    ]


def window_crops(strips: Sequence[LabelledStrip], step_px: int, rng: np.random.Generator | None) -> Crops:
    """Crops by a window that slides over each strip; with `rng` the kinds are balanced as in the paper: the rarer kinds
    of defect are repeated to the number of the most frequent one, the OK crops are cut down to the number of all (repeated if fewer)."""
    places = [
        (i, c, strip.crop_label(c))
        for i, strip in enumerate(strips)
        for c in range(0, STRIP_COLUMNS - STRIP_COLUMNS % step_px, step_px)
    ]
    labels = np.array([label for _, _, label in places])
    chosen = np.flatnonzero(labels != IGNORED)
    if rng is not None:
        pools = {kind: chosen[labels[chosen] == kind] for kind in (OK, *DEFECTS)}
        lacking = [CLASSES[kind] for kind, pool in pools.items() if not pool.size]
        if lacking:
            raise LearningError(f"the parts to train on show no {', '.join(lacking)}; label more parts")
        most = max(len(pools[kind]) for kind in DEFECTS)
        wanted = {OK: len(DEFECTS) * most, **dict.fromkeys(DEFECTS, most)}
        chosen = np.concatenate([_resampled(pool, wanted[kind], rng) for kind, pool in pools.items()])
    return _cut(strips, [places[i] for i in chosen])


def station_crops(strips: Sequence[LabelledStrip]) -> Crops:
    """The 21 crops of each strip as the station cuts them, those whose label is open left out."""
    places = [
        (i, c, s.crop_label(c))
        for i, s in enumerate(strips)
        for c in range(0, SEGMENTS * SEGMENT_PX, SEGMENT_PX)
    ]
    return _cut(strips, [p for p in places if p[2] != IGNORED])


def _cut(strips: Sequence[LabelledStrip], places: Sequence[tuple[int, int, int]]) -> Crops:
    images = np.empty((len(places), SEGMENT_PX, SEGMENT_PX), np.uint8)
    for number, (index, column, _) in enumerate(places):
        images[number] = strips[index].crop(column)
    return Crops(
        images=images,
        labels=np.array([label for _, _, label in places], np.int64),
        maps=empty_maps(len(places)),
        mapped=np.zeros(len(places), bool),
        parts=np.array([strips[i].part for i, _, _ in places], np.str_),
        names=np.array(
            [f"{strips[i].part}, {c * 360 / STRIP_COLUMNS:.0f} degrees" for i, c, _ in places], np.str_
        ),
    )


def _resampled(pool: NDArray[np.int64], count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    if count <= pool.size:
        return np.asarray(rng.choice(pool, count, replace=False), np.int64)
    return np.concatenate(
        [np.tile(pool, count // pool.size), rng.choice(pool, count % pool.size, replace=False)]
    )


def split_by_part(
    strips: Sequence[LabelledStrip], seed: int
) -> tuple[list[LabelledStrip], list[LabelledStrip], list[LabelledStrip]]:
    """Training, validation and test strips, 70/15/15 %: all strips of one part on one side, each side with its share of defects.

    Raises LearningError if there are too few parts.
    """
    parts = sorted({s.part: max((d.label for d in s.defects), default=OK) for s in strips}.items())
    rng = np.random.default_rng(seed)
    sides: dict[str, int] = {}
    owed = np.zeros(3)
    for kind in (*reversed(DEFECTS), OK):
        for name in rng.permutation([n for n, k in parts if k == kind]):
            owed += SHARES
            side = int(np.argmax(owed))
            owed[side] -= 1
            sides[str(name)] = side
    train, validate, test = ([s for s in strips if sides[s.part] == side] for side in range(3))
    if not (train and validate and test):
        raise LearningError(f"{len(parts)} parts are too few to split by part; at least 7 are needed")
    return train, validate, test


def read_labels(folder: Path) -> list[dict[str, Any]]:
    """Entries of `labels.json`. Raises LearningError listing all that is wrong: entries, absent and doubled images."""
    path = folder / "labels.json"
    try:
        labels = json.loads(path.read_text(encoding="utf-8"))["frames"]
        named = [(str(item["frame"]), item) for item in labels]
    except FileNotFoundError:
        raise LearningError(
            f"{path}: no such file; render a lot first with weldgate-synth part --out {folder}"
        ) from None
    except (ValueError, KeyError, TypeError):
        raise LearningError(f"{path}: not a labels file") from None
    if not named:
        raise LearningError(f"{path}: names no image")
    wrong = [f"{name}: {problem}" for name, item in named if (problem := _problem(item))]
    wrong += [
        f"{name}: the image is missing" for name, _ in named if not (folder / "frames" / name).is_file()
    ]
    seen: set[str] = set()
    wrong += [f"{name}: labelled twice" for name, _ in named if name in seen or seen.add(name)]  # type: ignore[func-returns-value]
    if wrong:
        raise LearningError(listed(folder, wrong))
    return [item for _, item in named]


def data_hash(folders: Sequence[Path]) -> str:
    """SHA-256 over the labels and the images of lots, images in the order of their names."""
    digest = hashlib.sha256()
    for folder in folders:
        digest.update((folder / "labels.json").read_bytes())
        for path in sorted((folder / "frames").glob("*.png")):
            digest.update(path.read_bytes())
    return digest.hexdigest()


def _problem(item: dict[str, Any]) -> str | None:
    """What is wrong with an entry."""
    try:
        x, y = item["center"]
        if not (float(item["radius"]) > 0 and np.isfinite([x, y, item["radius"]]).all()):
            return "centre and radius must be numbers"
        for defect in item["defects"]:
            start, end = defect["angle_deg"]
            if _name_of(defect) not in LABELS:
                return f"unknown kind {defect['kind']}; known: {', '.join(LABELS)}"
            if not 0 <= float(end) - float(start) <= 360:
                return (
                    f"angle_deg {defect['angle_deg']} must be [start, end], end 0 to 360 degrees after start"
                )
        if item["verdict"] not in ("OK", "NOK") or (item["verdict"] == "NOK") != bool(item["defects"]):
            return f"verdict {item['verdict']} does not fit {len(item['defects'])} defects"
    except (KeyError, ValueError, TypeError) as error:
        return f"the entry lacks or garbles {error}"
    return None


def _name_of(defect: dict[str, Any]) -> str:
    return OLD_NAMES.get(str(defect["kind"]), str(defect["kind"]))


def defects_of(item: dict[str, Any]) -> tuple[Defect, ...]:
    """Defects of one labelled part."""
    return tuple(
        Defect(LABELS[_name_of(d)], float(d["angle_deg"][0]), float(d["angle_deg"][1]))
        for d in item["defects"]
    )

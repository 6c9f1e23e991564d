"""Strips and crops of the labelled parts of lots, cut by the station's own unwrap.

The published protocol for real images (section 3.2 of the paper) is a window that slides by 10 px, kinds
balanced by repeating and leaving out, and a split by part of 70/15/15 %.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.data.crops import DEFECTS, IGNORED, OK, Crops, empty_maps
from models.data.lot import Defect, frames, read_labels
from models.errors import LearningError, listed
from station.classify.crop_label import crop_label
from station.classify.onnx import CLASSES
from station.domain import SEGMENT_DEG, SEGMENT_PX, SEGMENTS, STRIP_COLUMNS, Ring
from station.errors import LocateError
from station.vision.unwrap import unwrap

WINDOW_STEP_PX = 10
"""Step of the sliding window along the weld."""
SIDES = (0.70, 0.15, 0.15)
"""Fractions of the parts for training, validation and test."""


@dataclass(frozen=True, slots=True, eq=False)
class LabelledStrip:
    """One unwrapped part: strip (128, 2688) uint8 and its defects."""

    part: str
    strip: NDArray[np.uint8]
    defects: tuple[Defect, ...]

    def crop(self, column: int) -> NDArray[np.uint8]:
        """Return the crop (128, 128) that starts at `column`; it may reach over the seam."""
        return self.strip[:, np.arange(column, column + SEGMENT_PX) % STRIP_COLUMNS]

    def label_at(self, column: int) -> int:
        """Return the label of the crop that starts at `column`: OK, that of a kind of defect, or IGNORED."""
        start = column * 360.0 / STRIP_COLUMNS
        return label_of_arc(self.defects, start, start + SEGMENT_DEG)


def label_of_arc(defects: Sequence[Defect], start_deg: float, end_deg: float) -> int:
    """Return the label of the crop over the arc [start, end]: its gravest kind of defect, OK or IGNORED."""
    shown = crop_label(((CLASSES[d.label], d.start_deg, d.end_deg) for d in defects), start_deg, end_deg)
    return IGNORED if shown is None else CLASSES.index(shown)


def read_lot(folder: Path) -> list[LabelledStrip]:
    """Cut the strips of all parts at the labelled rings.

    Raises LearningError listing everything that is wrong.
    """
    strips, outside = [], []
    for label, image in frames(folder, read_labels(folder)):
        ring = Ring(label.center_x_px, label.center_y_px, label.radius_px, 1.0)
        try:
            strip = unwrap(image, ring, um_per_px=label.um_per_px)
        except LocateError as error:
            outside.append(f"{label.name}: {error}; correct its label")
            continue
        strips.append(LabelledStrip(label.name, strip, label.defects))
    if outside:
        raise LearningError(listed(folder, outside))
    return strips


def window_crops(strips: Sequence[LabelledStrip], step_px: int, rng: np.random.Generator | None) -> Crops:
    """Cut crops by a window that slides over each strip; with `rng` the kinds are balanced as in the paper.

    Then the crops of rarer kinds of defect are repeated to the number of the most frequent kind, and the OK
    crops are cut down to the number of all NOK ones (repeated if fewer). Raises LearningError if a kind is
    lacking.
    """
    columns = range(0, STRIP_COLUMNS - STRIP_COLUMNS % step_px, step_px)
    places = [(i, column, strip.label_at(column)) for i, strip in enumerate(strips) for column in columns]
    labels = np.array([label for _, _, label in places])
    chosen = np.flatnonzero(labels != IGNORED)
    if rng is not None:
        pools = {label: chosen[labels[chosen] == label] for label in (OK, *DEFECTS)}
        lacking = [CLASSES[label] for label, pool in pools.items() if not pool.size]
        if lacking:
            raise LearningError(f"the parts to train on show no {', '.join(lacking)}. Label more parts")
        most = max(len(pools[label]) for label in DEFECTS)
        counts = {OK: len(DEFECTS) * most, **dict.fromkeys(DEFECTS, most)}
        chosen = np.concatenate([_resampled(pool, counts[label], rng) for label, pool in pools.items()])
    return _cut(strips, [places[i] for i in chosen])


def station_crops(strips: Sequence[LabelledStrip]) -> Crops:
    """Cut the 21 crops of each strip as the station does, without those that a defect just touches."""
    columns = range(0, SEGMENTS * SEGMENT_PX, SEGMENT_PX)
    places = [(i, column, strip.label_at(column)) for i, strip in enumerate(strips) for column in columns]
    return _cut(strips, [place for place in places if place[2] != IGNORED])


def _cut(strips: Sequence[LabelledStrip], places: Sequence[tuple[int, int, int]]) -> Crops:
    images = np.empty((len(places), SEGMENT_PX, SEGMENT_PX), np.uint8)
    for number, (index, column, _) in enumerate(places):
        images[number] = strips[index].crop(column)
    names = [f"{strips[i].part}, {column * 360 / STRIP_COLUMNS:.0f} degrees" for i, column, _ in places]
    return Crops(
        images=images,
        labels=np.array([label for _, _, label in places], np.int64),
        maps=empty_maps(len(places)),
        mapped=np.zeros(len(places), bool),
        parts=np.array([strips[i].part for i, _, _ in places], np.str_),
        names=np.array(names, np.str_),
    )


def _resampled(pool: NDArray[np.int64], count: int, rng: np.random.Generator) -> NDArray[np.int64]:
    if count <= pool.size:
        return np.asarray(rng.choice(pool, count, replace=False), np.int64)
    repeated, rest = np.tile(pool, count // pool.size), rng.choice(pool, count % pool.size, replace=False)
    return np.concatenate([repeated, rest])


def split_by_part(
    strips: Sequence[LabelledStrip], seed: int
) -> tuple[list[LabelledStrip], list[LabelledStrip], list[LabelledStrip]]:
    """Return training, validation and test strips, 70/15/15 %.

    All strips of one part are on one side, and each side has its fraction of each kind of defect. Raises
    LearningError if there are too few parts.
    """
    gravest = {strip.part: max((d.label for d in strip.defects), default=OK) for strip in strips}
    parts = sorted(gravest.items())
    rng = np.random.default_rng(seed)
    sides: dict[str, int] = {}
    owed = np.zeros(3)
    for label in (*reversed(DEFECTS), OK):
        for name in rng.permutation([part for part, shown in parts if shown == label]):
            owed += SIDES
            side = int(np.argmax(owed))
            owed[side] -= 1
            sides[str(name)] = side
    train, validate, test = ([strip for strip in strips if sides[strip.part] == side] for side in range(3))
    if not (train and validate and test):
        raise LearningError(f"{len(parts)} parts are too few to split. Label at least 7")
    return train, validate, test

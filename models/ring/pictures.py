"""Training pictures of the ring network: lots at 52 µm/px whose masks say where bead and bare joint are."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from models.errors import LearningError, listed
from station.errors import ImageError
from station.files.image import read_image
from station.vision.reduced import FINDER_UM_PER_PX, Circle

NOTHING, BEAD, JOINT, HOLE = range(4)
"""Values of a mask; a hole counts as bead, because the weld's borders are those around it."""

HELD_OUT_EVERY = 10
"""One picture in this many is held out."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Picture:
    """One training picture with the truth about it."""

    name: str
    image: NDArray[np.uint8]
    """Picture (height, width) uint8 at 52 µm/px."""
    masks: NDArray[np.uint8]
    """Where bead and where bare joint is (height, width, 2) uint8, 0 or 255."""
    circle: Circle | None
    """Circle of the bead's centre line; None if the picture shows no ring."""
    weld: str | None
    """Family of the weld."""
    sheet: str
    """Finish of the sheet."""
    disc: str
    """Finish of the disc inside the ring."""

    @property
    def families(self) -> set[str]:
        """Names of its weld family and of its finishes."""
        return {self.sheet, self.disc, *(() if self.weld is None else (self.weld,))}


def read_pictures(lots: Sequence[Path]) -> list[Picture]:
    """Return the pictures of lots, in the order of their labels. Raises LearningError."""
    return [picture for lot in lots for picture in _read_lot(lot)]


def split(pictures: Sequence[Picture], left_out: Sequence[str]) -> tuple[list[Picture], list[Picture]]:
    """Return the pictures to train on and those held out.

    Held out are those of the weld families and sheet finishes in `left_out`; without any, every tenth. Raises
    LearningError if either is empty.
    """
    if not left_out:
        held = [index % HELD_OUT_EVERY == HELD_OUT_EVERY - 1 for index in range(len(pictures))]
    else:
        held = [bool(picture.families & {*left_out}) for picture in pictures]
    training = [picture for picture, out in zip(pictures, held, strict=True) if not out]
    held_out = [picture for picture, out in zip(pictures, held, strict=True) if out]
    if not (training and held_out):
        known = sorted({name for picture in pictures for name in picture.families})
        what = "at least 10 pictures" if not left_out else f"one of {', '.join(known)} to leave out"
        raise LearningError(f"{len(training)} pictures to train on, {len(held_out)} held out. Name {what}")
    return training, held_out


def _read_lot(lot: Path) -> list[Picture]:
    path = lot / "labels.json"
    try:
        labels = json.loads(path.read_text(encoding="utf-8"))
        scale, entries = float(labels["um_per_px"]), list(labels["frames"])
    except OSError as error:
        raise LearningError(f"{path}: cannot be read ({error.strerror}). Name a lot with masks") from None
    except (ValueError, KeyError, TypeError):
        raise LearningError(f"{path}: not the labels of a lot with masks. Make the lot again") from None
    if scale != FINDER_UM_PER_PX:
        raise LearningError(f"{lot}: made at {scale} µm/px, needed {FINDER_UM_PER_PX}. Make the lot again")
    found, wrong = [], []
    for entry in entries:
        try:
            found.append(_read_picture(lot, entry))
        except (ImageError, ValueError, KeyError, TypeError) as error:
            wrong.append(f"{entry.get('frame') if isinstance(entry, dict) else entry}: {error}")
    if wrong:
        raise LearningError(listed(lot, wrong))
    return found


def _read_picture(lot: Path, entry: dict) -> Picture:  # type: ignore[type-arg] # any JSON
    name = str(entry["frame"])
    image, mask = (read_image(lot / folder / name) for folder in ("frames", "masks"))
    if image.shape != mask.shape or mask.max(initial=0) > HOLE:
        raise ValueError("the mask does not fit the image")
    masks = np.stack([np.isin(mask, (BEAD, HOLE)), mask == JOINT], axis=2).astype(np.uint8) * 255
    circle = None
    if entry["center"] is not None:
        circle = Circle(float(entry["center"][0]), float(entry["center"][1]), float(entry["radius"]))
    weld = entry["weld"]
    return Picture(
        name=name,
        image=image,
        masks=masks,
        circle=circle,
        weld=None if weld is None else str(weld),
        sheet=str(entry["sheet"]),
        disc=str(entry.get("disc", entry["sheet"])),
    )

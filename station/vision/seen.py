"""Which segments were seen: bright, sharp, uncovered, with a weld between their borders; pure.

A network that judges a crop of nothing still gives scores. So each segment is looked at before they count.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray

from station.domain import SEGMENT_PX, SEGMENTS, Image, SegmentQuality, Unseen
from station.settings.quality import QualitySettings
from station.vision.locate import MIN_PRESENCE
from station.vision.quality import DARK_DN, SATURATED_DN
from station.vision.unwrap import segments

MIDDLE = slice(32, 96)
"""Rows of a crop that are measured: the weld, as what lies beside it may be dark, bright or plain."""
DETAIL_ROWS = slice(24, 104)
"""Rows in which the fine structure is measured."""
DIRECTIONS = (
    (np.s_[:, :, 3:], np.s_[:, :, :-3]),
    (np.s_[:, 3:, :], np.s_[:, :-3, :]),
    (np.s_[:, 2:, 2:], np.s_[:, :-2, :-2]),
    (np.s_[:, 2:, :-2], np.s_[:, :-2, 2:]),
)
"""Pairs of pixels about 3 px apart in crops (21, rows, columns): along, across, and both diagonals."""
LEVELS = np.arange(256, dtype=np.int64)
"""All grey levels."""


@dataclass(frozen=True, slots=True)
class Check:
    """One value of a segment with its limit."""

    cause: Unseen
    measured: str
    """Field of SegmentQuality."""
    end: Literal["min", "max"]
    """Whether the limit is a minimum or a maximum."""
    words: str
    """Text with a place for the value and the limit."""

    @property
    def limit_name(self) -> str:
        """Field of QualitySettings."""
        return f"{self.end}_segment_{self.measured}"

    def holds(self, quality: SegmentQuality, limits: QualitySettings) -> bool:
        """Return whether the value keeps its limit; a value that is not a number does not."""
        value, limit = getattr(quality, self.measured), getattr(limits, self.limit_name)
        if value is None:
            return True
        return bool(value >= limit if self.end == "min" else value <= limit)

    def text(self, qualities: Sequence[SegmentQuality], limits: QualitySettings) -> str:
        """Return the worst value of some segments and its limit as text."""
        ends = {"min": min, "max": max}
        worst = ends[self.end](qualities, key=lambda quality: float(getattr(quality, self.measured)))
        value = getattr(worst, self.measured)
        return self.words.format(
            value=value, percent=100 * value, mean=worst.mean_dn, limit=self._limit(limits)
        )

    def _limit(self, limits: QualitySettings) -> str:
        limit = float(getattr(limits, self.limit_name))
        return f"{100 * limit:g} %" if "{percent" in self.words else f"{limit:g}"


CHECKS = (
    Check(
        Unseen.NO_STRUCTURE,
        "contrast",
        "min",
        "contrast {value:.3f} at grey level {mean:.0f}, limit {limit}",
    ),
    Check(Unseen.TOO_DARK, "mean_dn", "min", "mean grey level {value:.1f}, limit {limit}"),
    Check(
        Unseen.TOO_DARK,
        "dark_fraction",
        "max",
        f"{{percent:.0f}} % of it at grey level {DARK_DN} or below, limit {{limit}}",
    ),
    Check(
        Unseen.TOO_BRIGHT,
        "saturated_fraction",
        "max",
        f"{{percent:.0f}} % of it at grey level {SATURATED_DN} or above, limit {{limit}}",
    ),
    Check(Unseen.BLURRED, "sharpness", "min", "sharpness {value:.3f}, limit {limit}"),
    Check(
        Unseen.BLURRED,
        "fine_structure",
        "min",
        "fine structure {value:.2f} of that of the other segments, limit {limit}",
    ),
    Check(Unseen.NO_WELD, "weld", "min", "weld in {percent:.0f} % of it, limit {limit}"),
    Check(Unseen.COVERED, "visible", "min", "{percent:.0f} % of it visible, limit {limit}"),
)
"""All checks of a segment; the first that does not hold is why the segment was not seen."""


def measure_segments(
    crops: Image, presence: NDArray[np.float64], visible: Sequence[float] | None = None
) -> tuple[SegmentQuality, ...]:
    """Return the image quality of each of the 21 crops (21, 128, 128) uint8.

    `presence` (84,) float64 is that of weld or joint on the circle by sector, see `station.vision.locate`;
    `visible` is the visible fraction of each segment, see `visible_fractions`, or None if no network tells
    it.
    """
    welds = (presence.reshape(SEGMENTS, -1) >= MIN_PRESENCE).mean(axis=1)
    structures = fine_structure(crops)
    return tuple(
        _measured(crop, structure, weld=weld, visible=None if visible is None else visible[i])
        for i, (crop, structure, weld) in enumerate(
            zip(crops, structures.tolist(), welds.tolist(), strict=True)
        )
    )


def fine_structure(crops: Image) -> NDArray[np.float64]:
    """Return the fine structure (21,) of each crop in its weakest direction, relative to the median crop.

    Differences of grey levels about 3 px apart, along the weld, across it and along both diagonals, root mean
    square, by the mean grey level. A weld looks much the same all round its ring; a movement takes the
    structure of one direction, a wrong focus that of all.
    """
    smooth = np.stack([cv2.GaussianBlur(crop[DETAIL_ROWS], (0, 0), 1.0) for crop in crops]).astype(np.int32)
    levels = np.maximum(smooth.mean(axis=(1, 2)), 1.0)
    relative = []
    for first, second in DIRECTIONS:
        steps = smooth[first] - smooth[second]
        strength = np.sqrt((steps * steps).mean(axis=(1, 2))) / levels
        relative.append(strength / max(float(np.median(strength)), 1e-9))
    return np.asarray(np.min(relative, axis=0), np.float64)


def hidden_columns(strip: Image, find_hidden: Callable[[Image], NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return how much of the weld is hidden (21, 16), by segment and column, on a strip (128, 2688) uint8.

    `find_hidden` answers for the 16 columns (K, 16) of crops (K, 128, 128). Each column is looked at in the
    middle half of a crop: at the ends of a crop half of the surroundings are missing.
    """
    half = SEGMENT_PX // 4
    first, second = (find_hidden(segments(np.roll(strip, shift, axis=1))) for shift in (half, -half))
    middle = slice(first.shape[1] // 4, first.shape[1] * 3 // 4)
    return np.concatenate([first[:, middle], second[:, middle]], axis=1)


def visible_fractions(hidden: NDArray[np.float64]) -> tuple[float, ...]:
    """Return how much of each segment's weld is visible, where it is hidden most.

    `hidden` (21, 16) is the hidden fraction of the weld in 16 columns of each crop. A cover counts from two
    columns on, 0.2 mm.
    """
    widest = (hidden[:, :-1] + hidden[:, 1:]) / 2
    return tuple(float(value) for value in 1.0 - widest.max(axis=1))


def _measured(crop: Image, structure: float, *, weld: float, visible: float | None) -> SegmentQuality:
    # whole numbers: one pass over the pixels, and the same to the bit on every PC
    rows = np.ascontiguousarray(crop[MIDDLE])
    size, counts = rows.size, np.bincount(rows.ravel(), minlength=LEVELS.size)
    total, squares = int(counts @ LEVELS), int(counts @ LEVELS**2)
    mean_dn = total / size
    divisor = max(mean_dn, 1.0)
    laplacian = cv2.Laplacian(rows, cv2.CV_16S)
    return SegmentQuality(
        mean_dn=mean_dn,
        dark_fraction=int(counts[: DARK_DN + 1].sum()) / size,
        saturated_fraction=int(counts[SATURATED_DN:].sum()) / size,
        contrast=sqrt(size * squares - total**2) / size / divisor,
        sharpness=sqrt(cv2.norm(laplacian, cv2.NORM_L2SQR) / size) / divisor,
        fine_structure=structure,
        weld=weld,
        visible=visible,
    )


def causes(qualities: Sequence[SegmentQuality], limits: QualitySettings) -> tuple[Unseen | None, ...]:
    """Return why each segment was not seen, None for one that was."""
    failed = (_first_failed(quality, limits) for quality in qualities)
    return tuple(None if check is None else check.cause for check in failed)


def _first_failed(quality: SegmentQuality, limits: QualitySettings) -> Check | None:
    return next((check for check in CHECKS if not check.holds(quality, limits)), None)


def words(
    qualities: Sequence[SegmentQuality], limits: QualitySettings, rejected: Sequence[object] = ()
) -> str | None:
    """Return one line with the segments that were not seen, why, and the worst value; None if all were.

    Segments that are rejected are left out: what is seen to be bad was seen.
    """
    found: dict[Check, list[int]] = {}
    for index, quality in enumerate(qualities):
        check = _first_failed(quality, limits)
        if check is not None and not (rejected and rejected[index]):
            found.setdefault(check, []).append(index)
    lines = (
        f"segment{'s' * (len(own) > 1)} {', '.join(str(index + 1) for index in own)}: {check.cause} "
        f"({check.text([qualities[index] for index in own], limits)})"
        for check, own in found.items()
    )
    return "; ".join(lines) or None

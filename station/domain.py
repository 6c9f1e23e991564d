"""Frozen data classes that travel through the station: frame, ring, scores, findings and inspection.

Pixels are (x, y) with y down; the centre of the image's top left pixel is (0, 0). Angles are in degrees, 0 at
+x, clockwise as seen in the image. Arrays are indexed (row, column). Names carry their units.
"""

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from datetime import datetime
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from station.defects import DefectKind, Reason

Image = NDArray[np.uint8]
"""Grey image (height, width) uint8, or several of them with leading axes."""

SEGMENTS = 21
"""Number of segments of the ring."""
SEGMENT_PX = 128
"""Side of a crop in pixels."""
STRIP_COLUMNS = SEGMENTS * SEGMENT_PX
"""Width of the strip in pixels: once round the ring."""
STRIP_ROWS = SEGMENT_PX
"""Height of the strip in pixels."""
SEGMENT_DEG = 360.0 / SEGMENTS
"""Angle of one segment in degrees."""
NETWORK_UM_PER_PX = 13.0
"""Scale of the networks' training images in µm per pixel: the height of a row of every strip."""
TRAINED_UM_PER_PX = (9.0, 65.0)
"""Lowest and highest scale, in µm per pixel, of the images whose strips the networks are trained for."""


class Purpose(StrEnum):
    """Why a frame was taken; only the verdict of a `PART` can release a part."""

    PART = "part"
    GOLDEN = "golden"
    """A master, inspected on request of the PLC."""
    TEST = "test"
    """A test image, inspected on request of a person and not reported to the PLC."""


class Verdict(StrEnum):
    """Result of inspecting a part; ERROR means that it was not inspected, and is never a kind of OK."""

    OK = "OK"
    NOK = "NOK"
    ERROR = "ERROR"


class Origin(StrEnum):
    """Source of a frame; only frames from `CAMERA` can release a part."""

    CAMERA = "camera"
    SIMULATED = "simulated"
    REPLAY = "replay"


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One image as grabbed by the camera: `image` (height, width) uint8, never changed afterwards."""

    image: Image
    grabbed_at: datetime
    source: str
    """Serial number of the camera, or file name."""
    origin: Origin
    unrequested: int = field(default=0, kw_only=True)
    """Number of frames that were dropped before it, as no trigger had asked for them."""
    features: str = field(default="", kw_only=True)
    """All features of the camera, as text; empty for a recorded image."""


@dataclass(frozen=True, slots=True)
class Ring:
    """Circle fitted to the weld's centre line, in frame pixels."""

    center_x_px: float
    center_y_px: float
    radius_px: float
    support: float
    """Fraction of the circumference where weld or joint was seen, 0 to 1."""
    residual_px: float = field(default=0.0, kw_only=True)
    """Root mean square distance of the weld or joint from the circle, where it was seen."""


@dataclass(frozen=True, slots=True)
class Quality:
    """Image quality, measured on the strip."""

    mean_dn: float
    """Mean grey level, 0 to 255."""
    dark_share: float
    """Fraction of the pixels at grey level 2 or below."""
    saturated_share: float
    """Fraction of the pixels at grey level 254 or above."""
    sharpness: float
    """Root mean square of the Laplacian, divided by the mean grey level."""


class Unseen(StrEnum):
    """Why a segment was not seen, so that its scores say nothing."""

    NO_STRUCTURE = "no structure"
    TOO_DARK = "too dark"
    TOO_BRIGHT = "too bright"
    BLURRED = "blurred"
    NO_WELD = "no weld between its borders"
    COVERED = "covered"


@dataclass(frozen=True, slots=True, kw_only=True)
class SegmentQuality:
    """What shows whether a segment was seen, measured on the middle rows of its crop, where the weld is."""

    mean_dn: float
    """Mean grey level, 0 to 255."""
    dark_fraction: float
    """Fraction of the pixels at grey level 2 or below."""
    saturated_fraction: float
    """Fraction of the pixels at grey level 254 or above."""
    contrast: float
    """Standard deviation of the grey level, divided by its mean."""
    sharpness: float
    """Root mean square of the Laplacian, divided by the mean grey level."""
    fine_structure: float
    """Fine structure in its weakest direction, relative to the median segment of the part; about 1."""
    weld: float
    """Fraction of the segment in which weld or joint lies on the ring, 0 to 1."""
    visible: float | None = None
    """Fraction of the segment that nothing covers, 0 to 1, as a network sees it; None without one."""


@dataclass(frozen=True, slots=True)
class SegmentScores:
    """Probabilities of one segment: OK, and each defect kind that the classifier knows; their sum is 1."""

    ok: float
    defects: Mapping[DefectKind, float]

    @property
    def nok(self) -> float:
        """Probability that the segment is NOK, of any defect kind."""
        return 1.0 - self.ok


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One defect measured on a part, merged over neighbouring segments."""

    kind: Reason
    start_deg: float
    end_deg: float
    """End angle; exceeds 360 if the finding crosses angle 0."""
    length_mm: float
    """Length along the weld."""
    score: float
    """Highest score of NOK among the segments of the finding."""
    width_mm: float | None = None
    """Width across the weld; None, like the area, if only whole segments are known to be defective."""
    area_mm2: float | None = None

    def __post_init__(self) -> None:
        if not -360 <= self.start_deg <= self.end_deg <= 1080:
            raise ValueError(f"a finding from {self.start_deg} to {self.end_deg} degrees is not on a ring")


@dataclass(frozen=True, slots=True)
class Timing:
    """Duration of each step in milliseconds; None if the step was not reached."""

    grab_ms: float | None = None
    locate_ms: float | None = None
    unwrap_ms: float | None = None
    classify_ms: float | None = None
    record_ms: float | None = field(default=None, kw_only=True)


@dataclass(frozen=True, slots=True)
class Inspection:
    """Result of inspecting one part; OK requires 21 segments, all of them seen and judged, none rejected."""

    verdict: Verdict
    reason: Reason | None
    _: KW_ONLY
    ring: Ring | None = None
    quality: Quality | None = None
    scores: tuple[SegmentScores, ...] = ()
    findings: tuple[Finding, ...] = ()
    timing: Timing = field(default_factory=Timing)
    rejected: tuple[Reason | None, ...] = ()
    """Defect kind for which each of the 21 segments is rejected, None for a segment that is not; empty if
    none was judged."""
    novelty: float | None = None
    """Distance of the part's appearance from the training images; about 1 for a training image."""
    look: tuple[float, ...] = ()
    """Appearance features of the part: mean over its crops, whitened on the training crops (zero mean, unit
    covariance)."""
    segment_quality: tuple[SegmentQuality, ...] = ()
    """Image quality of each of the 21 segments; empty if it was not measured."""
    unseen: tuple[Unseen | None, ...] = ()
    """Why each of the 21 segments was not seen, None for one that was; empty if none was looked at."""
    detail: str | None = None
    """One line with the numbers behind the reason, and with the segments that were not seen."""

    def __post_init__(self) -> None:
        judged = len(self.scores) == SEGMENTS and self.ring is not None
        seen = len(self.unseen) == SEGMENTS and not any(self.unseen)
        if self.verdict is Verdict.OK and not (
            judged and seen and self.reason is None and not any(self.rejected)
        ):
            raise ValueError("OK needs a ring, 21 judged segments, all seen, none rejected, and no reason")
        if len(self.rejected) != len(self.scores):
            raise ValueError(f"{len(self.scores)} scores, but {len(self.rejected)} decisions on them")
        for name in ("scores", "segment_quality", "unseen"):
            if len(getattr(self, name)) not in (0, SEGMENTS):
                raise ValueError(f"{name} has {len(getattr(self, name))} entries, needed 0 or {SEGMENTS}")

    @property
    def nok(self) -> tuple[bool, ...]:
        """True for each of the 21 segments that is rejected; empty if none was judged."""
        return tuple(kind is not None for kind in self.rejected)

    @property
    def invalid(self) -> tuple[bool, ...]:
        """True for each of the 21 segments that was not seen and is not rejected either.

        Its scores say nothing. Empty if none was looked at.
        """
        rejected = self.rejected or (None,) * len(self.unseen)
        return tuple(
            cause is not None and kind is None for cause, kind in zip(self.unseen, rejected, strict=True)
        )

    @property
    def nok_scores(self) -> tuple[float | None, ...]:
        """Score of NOK of each of the 21 segments, None for one that is invalid; empty if none was judged."""
        invalid = self.invalid or (False,) * len(self.scores)
        return tuple(
            None if says_nothing else scores.nok
            for scores, says_nothing in zip(self.scores, invalid, strict=False)
        )

    @property
    def worst(self) -> float | None:
        """Highest score of NOK of the segments that are not invalid; None if there is none."""
        return max((score for score in self.nok_scores if score is not None), default=None)

    @staticmethod
    def error(
        reason: Reason,
        ring: Ring | None = None,
        quality: Quality | None = None,
        timing: Timing | None = None,
        *,
        detail: str | None = None,
    ) -> "Inspection":
        """Return the result for a part that could not be judged."""
        return Inspection(
            Verdict.ERROR, reason, ring=ring, quality=quality, timing=timing or Timing(), detail=detail
        )

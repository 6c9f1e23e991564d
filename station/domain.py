"""The facts that travel through the station: frozen, with units in the names.

Pixels: (x, y), the centre of the image's top left pixel at (0, 0), y down. Angles: degrees, 0 at +x, clockwise as seen
in the image. Arrays: (row, column).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from station.defects import DefectKind, Reason

Image = NDArray[np.uint8]

SEGMENTS = 21
SEGMENT_PX = 128
STRIP_COLUMNS = SEGMENTS * SEGMENT_PX
STRIP_ROWS = SEGMENT_PX
SEGMENT_DEG = 360.0 / SEGMENTS


class Purpose(StrEnum):
    """Why a picture was taken; only a part's verdict releases anything."""

    PART = "part"
    GOLDEN = "golden"
    """A master, because the PLC asked for it."""
    TEST = "test"
    """Because a person at the station asked for it; the PLC is told nothing."""


class Verdict(StrEnum):
    """What the station says of a part. ERROR: not inspected; it is never a kind of OK."""

    OK = "OK"
    NOK = "NOK"
    ERROR = "ERROR"


class Origin(StrEnum):
    """Where a frame comes from; only `CAMERA` may release a part."""

    CAMERA = "camera"
    SIMULATED = "simulated"
    REPLAY = "replay"


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One picture as grabbed: `image` (H, W) uint8, never changed afterwards."""

    image: Image
    grabbed_at: datetime
    source: str
    """Camera serial or file name."""
    origin: Origin


@dataclass(frozen=True, slots=True)
class Ring:
    """The weld's centre line in frame pixels."""

    center_x_px: float
    center_y_px: float
    radius_px: float
    support: float
    """Share of the circumference where weld or joint was seen, 0 to 1."""
    residual_px: float = 0.0
    """Root mean square distance of what was seen there from the circle."""


@dataclass(frozen=True, slots=True)
class Quality:
    """Image quality on the unwrapped strip."""

    mean_dn: float
    dark_share: float
    """Share of pixels at grey level 2 or below."""
    saturated_share: float
    sharpness: float
    """Root mean square of the Laplacian over the mean grey level."""


@dataclass(frozen=True, slots=True)
class SegmentScores:
    """Probabilities of one segment: OK, and each kind of defect that the classifier knows. They add up to 1."""

    ok: float
    defects: Mapping[DefectKind, float]

    @property
    def nok(self) -> float:
        """Probability of the segment being NOK, whatever the kind of defect."""
        return 1.0 - self.ok


@dataclass(frozen=True, slots=True)
class Finding:
    """One defect, merged over neighbouring segments; `end_deg` may exceed 360."""

    kind: Reason
    start_deg: float
    end_deg: float
    length_mm: float
    """Along the weld."""
    score: float
    width_mm: float | None = None
    """Across the weld; None, as the area, if the defect was not seen apart from its segment."""
    area_mm2: float | None = None


@dataclass(frozen=True, slots=True)
class Timing:
    """Milliseconds of each step; None where the step was not reached."""

    grab_ms: float | None = None
    locate_ms: float | None = None
    unwrap_ms: float | None = None
    classify_ms: float | None = None
    record_ms: float | None = None


@dataclass(frozen=True, slots=True)
class Inspection:
    """One part as judged. OK only with 21 judged segments."""

    verdict: Verdict
    reason: Reason | None
    ring: Ring | None = None
    quality: Quality | None = None
    scores: tuple[SegmentScores, ...] = ()
    findings: tuple[Finding, ...] = ()
    timing: Timing = field(default_factory=Timing)
    rejected: tuple[Reason | None, ...] = ()
    """Kind of defect for which each of the 21 segments is rejected, None for the others; empty if none was judged."""
    novelty: float | None = None
    """Distance of the look of the part's crops to that of the training images; about 1 for these."""
    look: tuple[float, ...] = ()
    """What the part looks like, whatever it shows: mean over its crops, of mean 0 and covariance 1 over the training crops."""

    def __post_init__(self) -> None:
        judged = len(self.scores) == SEGMENTS and self.ring is not None
        if self.verdict is Verdict.OK and not (judged and self.reason is None and not any(self.rejected)):
            raise ValueError(
                "OK needs a ring, 21 judged segments, none of them rejected, and no reason against it"
            )
        if len(self.rejected) != len(self.scores):
            raise ValueError(f"{len(self.scores)} scores with {len(self.rejected)} decisions on them")

    @property
    def nok(self) -> tuple[bool, ...]:
        """True for each of the 21 segments that is rejected; empty if none was judged."""
        return tuple(kind is not None for kind in self.rejected)

    @staticmethod
    def error(
        reason: Reason, ring: Ring | None = None, quality: Quality | None = None, timing: Timing | None = None
    ) -> "Inspection":
        """A part that could not be judged."""
        return Inspection(Verdict.ERROR, reason, ring=ring, quality=quality, timing=timing or Timing())

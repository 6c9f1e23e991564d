"""What-if: which verdicts of recorded parts would flip with other limits, in both directions; pure.

Scores near the old threshold are averages over mirrored crops, other scores are not. So close to a new
threshold a part that is judged again may get another verdict; `weldgate replay` gives the exact result. A
segment that was not rejected has no measured length, so it is never tolerated.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from station.classify.decision import rejected_kinds
from station.classify.thresholds import Thresholds
from station.defects import Reason
from station.domain import Purpose, Verdict
from station.records import Record
from station.settings.model import QualitySettings
from station.vision.quality import gate

QUALITY = (Reason.TOO_DARK, Reason.TOO_BRIGHT, Reason.BLURRED)
"""Reasons of the image quality gate."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Flip:
    """A part whose verdict would flip."""

    inspection_id: int
    serial: str
    before: Verdict
    after: Verdict
    segment: int
    """Number of the segment with the highest score of NOK, 1 to 21."""
    score: float
    """Score of NOK of this segment."""


@dataclass(frozen=True, slots=True)
class WhatIf:
    """Result of a what-if."""

    compared: int
    """Number of parts with scores."""
    released: tuple[Flip, ...]
    """Parts that were NOK or not judged, and would be OK."""
    rejected: tuple[Flip, ...]
    """Parts that were OK, and would be NOK or not judged."""
    unknown: int
    """Number of parts without scores that would pass the new quality gate; their verdict is unknown."""


def what_if(records: Iterable[Record], thresholds: Thresholds, quality: QualitySettings) -> WhatIf:
    """Return what other limits would change for the recorded parts; masters and test images do not count."""
    compared, unknown = 0, 0
    released: list[Flip] = []
    rejected: list[Flip] = []
    for record in records:
        inspection = record.inspection
        if record.purpose is not Purpose.PART:
            continue
        fails_gate = inspection.quality is not None and gate(inspection.quality, quality) is not None
        if not inspection.scores:
            unknown += inspection.reason in QUALITY and not fails_gate
            continue
        compared += 1
        bad = any(rejected_kinds(inspection.scores, inspection.findings, thresholds))
        after = Verdict.ERROR if fails_gate else Verdict.NOK if bad else Verdict.OK
        if (after is Verdict.OK) == (record.verdict is Verdict.OK):
            continue
        worst = max(range(len(inspection.scores)), key=lambda i: inspection.scores[i].nok)
        flip = Flip(
            inspection_id=record.inspection_id,
            serial=record.serial,
            before=record.verdict,
            after=after,
            segment=worst + 1,
            score=inspection.scores[worst].nok,
        )
        (released if after is Verdict.OK else rejected).append(flip)
    return WhatIf(compared, tuple(released), tuple(rejected), unknown)

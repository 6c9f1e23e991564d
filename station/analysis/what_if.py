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
from station.inspection.verdict import Novel, Novelty, decide
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


@dataclass(frozen=True, slots=True, kw_only=True)
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
    unlike: int
    """Number of parts unlike the training images, without any other fault: OK with model.novel = flag, not
    judged with error."""


def what_if(
    records: Iterable[Record],
    thresholds: Thresholds,
    quality: QualitySettings,
    *,
    novelty_limit: float,
    novel: Novel,
) -> WhatIf:
    """Return what other limits would change for the recorded parts; masters and test images do not count.

    `novelty_limit` is that of the classifier; `novel` is what becomes of parts above it.
    """
    compared, unknown, unlike = 0, 0, 0
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
        rejected_now = rejected_kinds(inspection.scores, inspection.findings, thresholds)
        novelty = Novelty(inspection.novelty or 0.0, novelty_limit, novel)
        after, reason, _ = decide(
            rejected_now, inspection.findings, inspection.segment_quality, limits=quality, novelty=novelty
        )
        if fails_gate:
            after = Verdict.ERROR
        else:
            unlike += novelty.value > novelty_limit and (
                after is Verdict.OK or reason is Reason.UNLIKE_TRAINING
            )
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
    return WhatIf(
        compared=compared,
        released=tuple(released),
        rejected=tuple(rejected),
        unknown=unknown,
        unlike=unlike,
    )

"""What other limits would have made of the parts of the archive: which verdicts flip, both ways; pure.

Scores near the old threshold were seen twice (mirrored), others once: close to a new threshold a part judged anew may differ, which
`weldgate replay` tells exactly. What was not refused before has no length, and is never tolerated.
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


@dataclass(frozen=True, slots=True)
class Flip:
    """A part that would have got another verdict."""

    inspection_id: int
    serial: str
    before: Verdict
    after: Verdict
    segment: int
    """1 to 21: the one with the highest score of NOK."""
    score: float


@dataclass(frozen=True, slots=True)
class WhatIf:
    """Of parts with scores."""

    looked_at: int
    released: tuple[Flip, ...]
    """NOK or not judged before, OK now."""
    refused: tuple[Flip, ...]
    """OK before, NOK or not judged now."""
    unknown: int
    """Were too poor to be judged and would be judged now: nobody knows how."""


def what_if(records: Iterable[Record], thresholds: Thresholds, quality: QualitySettings) -> WhatIf:
    """Of parts alone: masters and test pictures do not count."""
    looked_at, unknown = 0, 0
    released: list[Flip] = []
    refused: list[Flip] = []
    for record in records:
        inspection = record.inspection
        if record.purpose is not Purpose.PART:
            continue
        poor = inspection.quality is not None and gate(inspection.quality, quality) is not None
        if not inspection.scores:
            unknown += inspection.reason in QUALITY and not poor
            continue
        looked_at += 1
        bad = any(rejected_kinds(inspection.scores, inspection.findings, thresholds))
        after = Verdict.ERROR if poor else Verdict.NOK if bad else Verdict.OK
        if (after is Verdict.OK) == (record.verdict is Verdict.OK):
            continue
        worst = max(range(len(inspection.scores)), key=lambda i: inspection.scores[i].nok)
        flip = Flip(
            record.inspection_id,
            record.serial,
            record.verdict,
            after,
            worst + 1,
            inspection.scores[worst].nok,
        )
        (released if after is Verdict.OK else refused).append(flip)
    return WhatIf(looked_at, tuple(released), tuple(refused), unknown)

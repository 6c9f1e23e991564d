"""The verdict on a part from what is known of its segments; pure.

What is seen to be bad is NOK, even if another segment was not seen. OK is said only of a part whose segments
were all seen, and which is like the training images.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from station.defects import Reason
from station.domain import Finding, SegmentQuality, Verdict
from station.settings.quality import QualitySettings
from station.vision.seen import words

Novel = Literal["error", "flag"]
"""What becomes of a part that would be OK but is unlike all training images."""


@dataclass(frozen=True, slots=True)
class Novelty:
    """Distance of a part from the training images, the limit, and what follows above it."""

    value: float
    limit: float
    above: Novel


def decide(
    rejected: Sequence[Reason | None],
    findings: Sequence[Finding],
    qualities: Sequence[SegmentQuality],
    *,
    limits: QualitySettings,
    novelty: Novelty,
) -> tuple[Verdict, Reason | None, str | None]:
    """Return verdict, reason and detail of a part with 21 decisions and the quality of its 21 segments."""
    not_seen = words(qualities, limits, rejected)
    reasons = sorted({kind for kind in rejected if kind is not None}, key=lambda kind: kind.code)
    if reasons:
        rejecting = (finding for finding in findings if finding.kind in reasons)
        worst = max(rejecting, key=lambda finding: finding.score, default=None)
        return Verdict.NOK, reasons[0] if worst is None else worst.kind, not_seen
    if not_seen is not None:
        return Verdict.ERROR, Reason.SEGMENT_NOT_SEEN, not_seen
    if novelty.above == "error" and not novelty.value <= novelty.limit:
        numbers = f"novelty {novelty.value:.2f}, limit {novelty.limit:g}"
        return Verdict.ERROR, Reason.UNLIKE_TRAINING, numbers
    return Verdict.OK, None, None

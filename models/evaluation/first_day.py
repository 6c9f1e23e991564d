"""The check before the first day of production, with OK parts alone.

It shows how much room the thresholds leave and whether the images are like the training images.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from station.analysis.truth import interval
from station.defects import Reason
from station.domain import Verdict
from station.files.image import read_image
from station.inspection.inspector import Inspector

FACTORS = (1.0, 0.7, 0.5, 0.3, 0.2, 0.1)
"""Factors of the thresholds at which the false rejects are counted."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class FirstDay:
    """Result of the check."""

    names: tuple[str, ...]
    """Files that were judged (N)."""
    room: NDArray[np.float64]
    """Largest score over its threshold (N,): rejected from 1 on."""
    novelty: NDArray[np.float64]
    """Distance to the training images (N,)."""
    limit: float
    """Novelty limit."""
    not_judged: tuple[str, ...]
    """Files that could not be judged, each with the reason."""
    looks: NDArray[np.float64]
    """Appearance features (N, 192)."""

    @property
    def good(self) -> bool:
        """True if production may begin: all parts judged, none rejected, none unlike the training images."""
        within = bool((self.room < 1).all() and (self.novelty <= self.limit).all())
        return not self.not_judged and within and len(self.names) > 0

    def lines(self) -> list[str]:
        """Return the result as text."""
        total = len(self.names)
        answer = [f"{total} OK parts judged, {len(self.not_judged)} not judged"]
        for factor in FACTORS if total else ():
            rejects = int((self.room >= factor).sum())
            low, high = interval(rejects, total)
            percent = f"{rejects / total:.1%} (95 %: {low:.1%} to {high:.1%})"
            answer.append(f"thresholds x {factor:.1f}: {rejects} rejected, {percent}")
        if total:
            median, worst = np.median(self.novelty), self.novelty.max()
            seen = f"median {median:.2f}, maximum {worst:.2f}, limit {self.limit:.2f}"
            answer.append(f"distance to the training images: {seen}")
        for name, room, novelty in zip(self.names, self.room, self.novelty, strict=True):
            if room >= 1:
                answer.append(
                    f"{name}: rejected. Check whether it shows a defect, or a surface new to the network"
                )
            if novelty > self.limit:
                unlike = f"{name}: unlike the training images (distance {novelty:.2f})"
                answer.append(f"{unlike}. Check light, focus and surface, or render such parts")
        answer += [f"{line}. Correct the image first" for line in self.not_judged]
        answer.append("ready" if self.good else "not ready")
        return answer


def first_day(
    paths: Sequence[Path], inspector: Inspector, limit: float, progress: Callable[[], None] = lambda: None
) -> FirstDay:
    """Judge images of parts known to be OK. Raises ImageError."""
    names, room, novelty, failed, looks = [], [], [], [], []
    limits = inspector.thresholds.kinds
    for path in paths:
        judged = inspector.inspect(read_image(path))
        not_judged = judged.verdict is Verdict.ERROR and judged.reason is not Reason.UNLIKE_TRAINING
        if not_judged or judged.novelty is None:
            failed.append(f"{path.name}: {judged.reason}" + (f", {judged.detail}" if judged.detail else ""))
        else:
            names.append(path.name)
            over = max(scores.defects[one.kind] / one.threshold for scores in judged.scores for one in limits)
            room.append(max(1.0, over) if judged.verdict is Verdict.NOK else over)
            novelty.append(judged.novelty)
            looks.append(judged.look)
        progress()
    return FirstDay(
        names=tuple(names),
        room=np.array(room),
        novelty=np.array(novelty),
        limit=limit,
        not_judged=tuple(failed),
        looks=np.array(looks),
    )

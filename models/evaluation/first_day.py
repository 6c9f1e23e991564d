"""The check for the first day of production: OK parts alone say how much room the thresholds leave, and whether the images are known."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from station.analysis.truth import interval
from station.domain import Verdict
from station.files.image import read_image
from station.inspection.inspector import Inspector

FACTORS = (1.0, 0.7, 0.5, 0.3, 0.2, 0.1)
"""Thresholds as shares of the file's."""


@dataclass(frozen=True, slots=True, eq=False)
class FirstDay:
    """What OK parts showed."""

    names: tuple[str, ...]
    room: NDArray[np.float64]
    """Of each judged part the largest score over its threshold: refused from 1 on."""
    novelty: NDArray[np.float64]
    limit: float
    not_judged: tuple[str, ...]
    looks: NDArray[np.float64]
    """(N, 192)"""

    @property
    def good(self) -> bool:
        """Whether production may begin: all parts judged, none refused, none unlike the training images."""
        return (
            not self.not_judged
            and bool((self.room < 1).all() and (self.novelty <= self.limit).all())
            and len(self.names) > 0
        )

    def lines(self) -> list[str]:
        """For people."""
        total = len(self.names)
        answer = [f"{total} OK parts judged, {len(self.not_judged)} not judged"]
        for factor in FACTORS if total else ():
            refused = int((self.room >= factor).sum())
            low, high = interval(refused, total)
            answer.append(
                f"thresholds x {factor:.1f}: {refused} refused, {refused / total:.1%} (95 %: {low:.1%} to {high:.1%})"
            )
        if total:
            seen = f"median {np.median(self.novelty):.2f}, worst {self.novelty.max():.2f}, limit {self.limit:.2f}"
            answer.append(f"distance to the training images: {seen}")
        for name, room, novelty in zip(self.names, self.room, self.novelty, strict=True):
            if room >= 1:
                answer.append(
                    f"{name}: refused; look at it: a defect, or a surface the network does not know"
                )
            if novelty > self.limit:
                answer.append(
                    f"{name}: unlike the training images (distance {novelty:.2f}); check light, focus and surface, or render such parts"
                )
        answer += [f"{line}; correct the picture before anything else" for line in self.not_judged]
        answer.append("ready" if self.good else "not ready")
        return answer


def first_day(
    paths: Sequence[Path], inspector: Inspector, limit: float, progress: Callable[[], None] = lambda: None
) -> FirstDay:
    """Judge images of parts known to be OK. Raises ImageError."""
    names, room, novelty, failed, looks = [], [], [], [], []
    thresholds = inspector.thresholds
    for path in paths:
        judged = inspector.inspect(read_image(path))
        if judged.verdict is Verdict.ERROR or judged.novelty is None:
            failed.append(f"{path.name}: {judged.reason}")
        else:
            names.append(path.name)
            over = [
                max(s.defects[limit.kind] / limit.threshold for limit in thresholds.kinds)
                for s in judged.scores
            ]
            room.append(max(1.0, max(over)) if judged.verdict is Verdict.NOK else max(over))
            novelty.append(judged.novelty)
            looks.append(judged.look)
        progress()
    return FirstDay(tuple(names), np.array(room), np.array(novelty), limit, tuple(failed), np.array(looks))

"""A lot judged by the shipped station code: ring error and verdicts against the labels."""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import hypot
from pathlib import Path
from statistics import median
from typing import Any

from models.data import IGNORED, OK, crop_label, defects_of, read_labels
from station.domain import SEGMENT_DEG, SEGMENTS, Inspection, Verdict
from station.imagefile import read_image
from station.inspection import Inspector


@dataclass(slots=True)
class Evaluation:
    """What came out; grows part by part."""

    parts: int = 0
    right: int = 0
    escapes: list[str] = field(default_factory=list)
    false_rejects: list[str] = field(default_factory=list)
    not_judged: list[str] = field(default_factory=list)
    center_error_px: list[float] = field(default_factory=list)
    radius_error_px: list[float] = field(default_factory=list)
    segments: dict[str, int] = field(default_factory=lambda: {"tp": 0, "fp": 0, "fn": 0, "tn": 0})

    def lines(self) -> list[str]:
        """For people."""
        tp, fp, fn = self.segments["tp"], self.segments["fp"], self.segments["fn"]
        precision, recall = tp / max(tp + fp, 1), tp / max(tp + fn, 1)
        f2 = 5 * precision * recall / max(4 * precision + recall, 1e-9)
        wrong = f"{len(self.escapes)} escapes, {len(self.false_rejects)} false rejects, {len(self.not_judged)} not judged"
        found = [f"{self.parts} parts: {self.right} right, {wrong}"]
        if self.center_error_px:
            found.append(
                f"ring found on {len(self.center_error_px)}, median and worst error: "
                f"centre {median(self.center_error_px):.2f}, {max(self.center_error_px):.2f} px; "
                f"radius {median(self.radius_error_px):.2f}, {max(self.radius_error_px):.2f} px"
            )
        found.append(f"segments: precision {precision:.3f}, recall {recall:.3f}, F2 {f2:.3f}")
        for title, names in (("escaped", self.escapes), ("falsely refused", self.false_rejects), ("not judged", self.not_judged)):
            if names:
                found.append(f"{title}: {', '.join(names)}")
        return found


def evaluate(lot: Path, inspector: Inspector, progress: Callable[[], None]) -> Evaluation:
    """Judge every frame of a lot. Raises LearningError, ImageError."""
    outcome = Evaluation()
    for item in read_labels(lot):
        judged = inspector.inspect(read_image(lot / "frames" / str(item["frame"])))
        _count_part(outcome, item, judged)
        _count_segments(outcome, item, judged, inspector)
        progress()
    return outcome


def _count_part(outcome: Evaluation, item: dict[str, Any], judged: Inspection) -> None:
    outcome.parts += 1
    if judged.verdict is Verdict.ERROR:
        outcome.not_judged.append(f"{item['frame']} ({judged.reason})")
    elif judged.verdict == item["verdict"]:
        outcome.right += 1
    else:
        (outcome.escapes if judged.verdict is Verdict.OK else outcome.false_rejects).append(str(item["frame"]))
    if judged.ring is not None:
        x, y = item["center"]
        outcome.center_error_px.append(hypot(judged.ring.center_x_px - x, judged.ring.center_y_px - y))
        outcome.radius_error_px.append(abs(judged.ring.radius_px - item["radius"]))


def _count_segments(outcome: Evaluation, item: dict[str, Any], judged: Inspection, inspector: Inspector) -> None:
    defects = defects_of(item)
    for index in range(SEGMENTS):
        label = crop_label(defects, index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG)
        if label == IGNORED:
            continue
        nok = index < len(judged.scores) and inspector.is_nok(judged.scores[index])
        outcome.segments[("t" if nok == (label != OK) else "f") + ("p" if nok else "n")] += 1

"""How accuracy and alarm respond to a line that drifts: labelled parts, changed more and more."""

import json
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from models.data.crops import IGNORED, OK
from models.data.labelled import LabelledStrip, read_lot
from models.evaluation.measures import Counts, count
from station.classify.decision import segment_kind
from station.classify.drift import DriftWatch, Reference
from station.classify.onnx import Classifier
from station.domain import SEGMENT_PX, SEGMENTS
from station.vision.unwrap import segments

STRENGTHS = (0.0, 0.15, 0.3, 0.45, 0.6, 0.8, 0.9, 1.0)
"""Strengths at which each drift is applied."""
Strip = NDArray[np.float32]
Change = Callable[[Strip, float, np.random.Generator], Strip]


@dataclass(frozen=True, slots=True)
class Step:
    """Result at one strength of one drift."""

    drift: str
    strength: float
    segments: Counts
    alarms: float
    """Fraction of the parts reported as unlike the training images or as drifting from the reference."""


def _dimmer(strip: Strip, strength: float, rng: np.random.Generator) -> Strip:
    """Fade the light to a twentieth while gain makes up for it: noise grows."""
    photons = strip * (1 - 0.95 * strength) * 10000 / 255
    noise = rng.standard_normal(strip.shape, dtype=np.float32) * np.sqrt(photons + 60.0**2 * strength)
    return np.asarray((photons + noise) * 255 / 10000 / (1 - 0.95 * strength), np.float32)


def _defocus(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """Move the camera out of focus: blur up to 7 px."""
    return np.asarray(cv2.GaussianBlur(strip, (0, 0), 7 * strength), np.float32)


def _haze(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """Cover the protective glass with a film: contrast falls to 3 %, in whole grey levels."""
    keep = 1 - 0.97 * strength
    return np.asarray(np.rint(strip * keep + float(strip.mean()) * (1 - keep)), np.float32)


def _lean(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """Switch off one row of the light: bright on one border of the weld, dark on the other."""
    ramp = np.linspace(-1, 1, strip.shape[0], dtype=np.float32)[:, None]
    return np.asarray(strip * np.exp(2.5 * strength * ramp), np.float32)


def _surface(strip: Strip, strength: float, rng: np.random.Generator) -> Strip:
    """Add dark pits of 50 um everywhere, on welds that are good."""
    pits = cv2.GaussianBlur(rng.standard_normal(strip.shape, dtype=np.float32), (0, 0), 2.0)
    return np.asarray(strip * np.exp(-2.5 * strength * np.maximum(pits / pits.std() - 0.8, 0)), np.float32)


def _exposure(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """Increase light or exposure up to four times, clipped."""
    return np.asarray(strip * (1 + 3 * strength), np.float32)


DRIFTS: dict[str, Change] = {
    "light fades, noise grows": _dimmer,
    "focus is lost": _defocus,
    "glass gets hazy": _haze,
    "light fails on one side": _lean,
    "another surface": _surface,
    "overexposure": _exposure,
}


def drift(
    lot: Path,
    classifier: Classifier,
    reference: Reference | None,
    progress: Callable[[], None] = lambda: None,
) -> list[Step]:
    """Judge a lot under each drift at each strength; without a reference, drift is not watched.

    Raises LearningError.
    """
    strips = read_lot(lot)
    steps = []
    for name, change in DRIFTS.items():
        for strength in STRENGTHS:
            drifted = _drifted(strips, change, strength)
            counts, alarms = _judge(drifted, strips, classifier, reference)
            steps.append(Step(name, strength, counts, alarms))
            progress()
    return steps


def _drifted(strips: Sequence[LabelledStrip], change: Change, strength: float) -> Iterator[NDArray[np.uint8]]:
    rng = np.random.default_rng(0)
    for strip in strips:
        changed = change(strip.strip.astype(np.float32), strength, rng) if strength > 0 else strip.strip
        yield np.clip(changed, 0, 255).astype(np.uint8)


def _judge(
    drifted: Iterable[NDArray[np.uint8]],
    strips: Sequence[LabelledStrip],
    classifier: Classifier,
    reference: Reference | None,
) -> tuple[Counts, float]:
    """Return the counts over all segments, and the fraction of the parts that are reported."""
    nok, truth, novel, looks = [], [], [], []
    for image, strip in zip(drifted, strips, strict=True):
        judged = classifier(segments(image))
        novel.append(judged.novelty > classifier.card.novelty_limit)
        looks.append(judged.appearances.mean(axis=0, dtype=np.float64))
        for index in range(SEGMENTS):
            label = strip.label_at(index * SEGMENT_PX)
            if label != IGNORED:
                nok.append(segment_kind(judged.scores[index], classifier.card.thresholds) is not None)
                truth.append(label != OK)
    reported = [a or b for a, b in zip(novel, _drifting(looks, reference), strict=True)]
    return count(np.array(nok), np.array(truth)), sum(reported) / len(reported)


def _drifting(looks: list[NDArray[np.float64]], reference: Reference | None) -> list[bool]:
    """Return for each part whether the watch raises the alarm after all parts have drifted."""
    if reference is None:
        return [False] * len(looks)
    watch = DriftWatch(reference)
    for look in looks:
        watch.part(look)
    return [watch.part(look).alarm for look in looks]


def write_drift(steps: list[Step], out: Path) -> None:
    """Write drift.json and drift.png into `out`."""
    from models.evaluation.figures import drift_curves

    out.mkdir(parents=True, exist_ok=True)
    rows = [
        {
            "drift": step.drift,
            "strength": step.strength,
            "precision": step.segments.precision,
            "recall": step.segments.recall,
            "f2": step.segments.f2,
            "alarms": step.alarms,
        }
        for step in steps
    ]
    (out / "drift.json").write_text(json.dumps(rows, indent=1) + "\n")
    by_name = {name: [step for step in steps if step.drift == name] for name in DRIFTS}
    curves = {name: ([s.segments.f2 for s in own], [s.alarms for s in own]) for name, own in by_name.items()}
    (out / "drift.png").write_bytes(drift_curves(STRENGTHS, curves))

"""How accuracy and alarm answer to a line that drifts: labelled parts, made worse step by step."""

import json
from collections.abc import Callable
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
from station.classify.thresholds import Thresholds
from station.domain import SEGMENT_PX, SEGMENTS
from station.vision.unwrap import segments

STRENGTHS = (0.0, 0.15, 0.3, 0.45, 0.6, 0.8, 0.9, 1.0)
Strip = NDArray[np.float32]


@dataclass(frozen=True, slots=True)
class Step:
    """Outcome at one strength of one drift."""

    drift: str
    strength: float
    segments: Counts
    alarms: float
    """Share of the parts that are reported: unlike the training images, or drifting from the reference."""


def _dimmer(strip: Strip, strength: float, rng: np.random.Generator) -> Strip:
    """The light fades to a twentieth while gain makes up for it: noise grows."""
    photons = strip * (1 - 0.95 * strength) * 10000 / 255
    noise = rng.standard_normal(strip.shape, dtype=np.float32) * np.sqrt(photons + 60.0**2 * strength)
    return np.asarray((photons + noise) * 255 / 10000 / (1 - 0.95 * strength), np.float32)


def _defocus(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """The camera sinks out of focus: blur up to 7 px."""
    return np.asarray(cv2.GaussianBlur(strip, (0, 0), 7 * strength), np.float32)


def _haze(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """A film grows on the protective glass: contrast falls to 3 %, then the camera counts only whole grey levels."""
    keep = 1 - 0.97 * strength
    return np.asarray(np.rint(strip * keep + float(strip.mean()) * (1 - keep)), np.float32)


def _lean(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """One row of the light dies: bright on one border of the weld, dark on the other."""
    ramp = np.linspace(-1, 1, strip.shape[0], dtype=np.float32)[:, None]
    return np.asarray(strip * np.exp(2.5 * strength * ramp), np.float32)


def _surface(strip: Strip, strength: float, rng: np.random.Generator) -> Strip:
    """Another surface: dark pits of 50 um everywhere, on welds that are good."""
    pits = cv2.GaussianBlur(rng.standard_normal(strip.shape, dtype=np.float32), (0, 0), 2.0)
    return np.asarray(strip * np.exp(-2.5 * strength * np.maximum(pits / pits.std() - 0.8, 0)), np.float32)


def _exposure(strip: Strip, strength: float, _: np.random.Generator) -> Strip:
    """The light grows, or the exposure: four times as bright, clipped."""
    return np.asarray(strip * (1 + 3 * strength), np.float32)


DRIFTS: dict[str, Callable[[Strip, float, np.random.Generator], Strip]] = {
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
    """Judge a lot under each drift at each strength; without a reference no drift is watched for. Raises LearningError."""
    strips = read_lot(lot)
    limits = classifier.card.thresholds
    steps = []
    for name, change in DRIFTS.items():
        for strength in STRENGTHS:
            steps.append(_step(name, strength, change, strips, classifier, limits, reference))
            progress()
    return steps


def _step(
    name: str,
    strength: float,
    change: Callable[[Strip, float, np.random.Generator], Strip],
    strips: list[LabelledStrip],
    classifier: Classifier,
    limits: Thresholds,
    reference: Reference | None,
) -> Step:
    rng = np.random.default_rng(0)
    nok, truth, novel, looks = [], [], [], []
    for strip in strips:
        drifted = change(strip.strip.astype(np.float32), strength, rng) if strength > 0 else strip.strip
        changed = np.clip(drifted, 0, 255).astype(np.uint8)
        judged = classifier(segments(changed))
        novel.append(judged.novelty > classifier.card.novelty_limit)
        looks.append(judged.looks.mean(axis=0, dtype=np.float64))
        for index in range(SEGMENTS):
            label = strip.crop_label(index * SEGMENT_PX)
            if label != IGNORED:
                nok.append(segment_kind(judged.scores[index], limits) is not None)
                truth.append(label != OK)
    told = [a or b for a, b in zip(novel, _drifting(looks, reference), strict=True)]
    return Step(name, strength, count(np.array(nok), np.array(truth)), sum(told) / len(told))


def _drifting(looks: list[NDArray[np.float64]], reference: Reference | None) -> list[bool]:
    """Of each part whether the watch gives the alarm, once the parts before it have drifted as well."""
    if reference is None:
        return [False] * len(looks)
    watch = DriftWatch(reference)
    for look in looks:
        watch.part(look)
    return [watch.part(look).alarm for look in looks]


def write_drift(steps: list[Step], out: Path) -> None:
    """`drift.json` and `drift.png` in `out`."""
    from models.evaluation.figures import drift_curves

    out.mkdir(parents=True, exist_ok=True)
    rows = [
        {
            "drift": s.drift,
            "strength": s.strength,
            "precision": s.segments.precision,
            "recall": s.segments.recall,
            "f2": s.segments.f2,
            "alarms": s.alarms,
        }
        for s in steps
    ]
    (out / "drift.json").write_text(json.dumps(rows, indent=1) + "\n")
    named = {
        name: (
            [s.segments.f2 for s in steps if s.drift == name],
            [s.alarms for s in steps if s.drift == name],
        )
        for name in DRIFTS
    }
    (out / "drift.png").write_bytes(drift_curves(STRENGTHS, named))

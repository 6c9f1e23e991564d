"""Frame to verdict: locate, unwrap, quality gate, classify, decide. No device, no file."""

from time import perf_counter

import numpy as np

from station.classify.decision import findings, mean_of, near_threshold, refused_kinds
from station.classify.drift import read_reference
from station.classify.onnx import LOOK, Classifier, RingNetwork
from station.classify.thresholds import Thresholds
from station.domain import Image, Inspection, Reason, Ring, SegmentScores, Timing, Verdict
from station.errors import LocateError, ModelError
from station.settings import ModelSettings, QualitySettings, WeldSettings
from station.vision.locate import Expected, locate
from station.vision.quality import gate, measure
from station.vision.unwrap import segments, unwrap

LOOK_DECIMALS = 3
"""Of a part's look; its components are about 1."""


class Inspector:
    """Judges frames with one model and one set of limits; the same for line and replay."""

    def __init__(
        self, ring_network: RingNetwork, classifier: Classifier, weld: WeldSettings, quality: QualitySettings, model: ModelSettings
    ) -> None:
        """Raises ModelError if the settings name a reference that does not fit."""
        self._ring_network = ring_network
        self.classifier = classifier
        self._weld = weld
        self._quality = quality
        px_per_mm = 1000.0 / weld.um_per_px
        self._expected = Expected(weld.radius_mm * px_per_mm, weld.radius_tolerance_mm * px_per_mm)
        self.card = card = classifier.card
        path = model.reference_path
        self.reference = None if path is None else read_reference(path, card.file_hash, LOOK)
        self.thresholds = Thresholds(
            hole=card.hole_threshold if model.hole_threshold is None else model.hole_threshold,
            missing_weld=card.missing_threshold if model.missing_threshold is None else model.missing_threshold,
            segments=tuple(sorted(model.segment_thresholds.items())),
            hole_min_mm=model.hole_min_mm,
            missing_min_mm=model.missing_min_mm,
        )

    def locate(self, image: Image) -> Ring:
        """Ring of the weld in `image` (H, W) uint8. Raises LocateError, ModelError."""
        return locate(image, self._expected, self._ring_network)

    def refused(self, judged: Inspection) -> tuple[bool, ...]:
        """Whether each segment is refused; empty if none was judged."""
        return tuple(kind is not None for kind in refused_kinds(judged.scores, judged.findings, self.thresholds))

    def is_novel(self, judged: Inspection) -> bool:
        """Whether a part looks unlike all training images, so that its verdict deserves less trust."""
        return judged.novelty is not None and judged.novelty > self.card.novelty_limit

    def inspect(self, image: Image, grab_ms: float | None = None) -> Inspection:
        """Judge `image` (H, W) uint8. Every way that does not end with 21 judged segments ends in ERROR."""
        start = perf_counter()
        try:
            ring = self.locate(image)
        except LocateError as error:
            reason = Reason.WELD_OUT_OF_VIEW if error.out_of_view else Reason.NO_WELD_FOUND
            return Inspection.error(reason, timing=Timing(grab_ms, _ms(start)))
        except ModelError:
            return Inspection.error(Reason.MODEL_FAILED, timing=Timing(grab_ms, _ms(start)))
        locate_ms, start = _ms(start), perf_counter()
        strip = unwrap(image, ring)
        quality = measure(strip)
        unwrap_ms, start = _ms(start), perf_counter()
        poor = gate(quality, self._quality)
        if poor is not None:
            return Inspection.error(poor, ring, quality, Timing(grab_ms, locate_ms, unwrap_ms))
        try:
            crops = segments(strip)
            judged = self.classifier(crops)
            scores = self._look_twice(crops, judged.scores)
        except ModelError:
            return Inspection.error(Reason.MODEL_FAILED, ring, quality, Timing(grab_ms, locate_ms, unwrap_ms))
        found = findings(scores, judged.maps, self.thresholds, ring, self._weld.um_per_px)
        refused = {kind for kind in refused_kinds(scores, found, self.thresholds) if kind is not None}
        worst = max((f for f in found if f.kind in refused), key=lambda f: f.score, default=None)
        return Inspection(
            verdict=Verdict.NOK if refused else Verdict.OK,
            reason=next(iter(refused), None) if worst is None else worst.kind,
            ring=ring,
            quality=quality,
            scores=scores,
            findings=found,
            timing=Timing(grab_ms, locate_ms, unwrap_ms, _ms(start)),
            novelty=judged.novelty,
            look=tuple(np.round(judged.looks.mean(axis=0, dtype=np.float64), LOOK_DECIMALS).tolist()),
        )

    def _look_twice(self, crops: Image, scores: tuple[SegmentScores, ...]) -> tuple[SegmentScores, ...]:
        """Segments near their threshold are seen again in the mirror: a mirrored weld is a weld, with the same defects."""
        near = [i for i, s in enumerate(scores) if near_threshold(s, self.thresholds.of(i))]
        if not near:
            return scores
        again = crops[near]
        views = np.concatenate([again[:, :, ::-1], again[:, ::-1], again[:, ::-1, ::-1]])
        mirrored = self.classifier(views).scores
        seen = {segment: (scores[segment], *mirrored[i :: len(near)]) for i, segment in enumerate(near)}
        return tuple(mean_of(seen[i]) if i in seen else s for i, s in enumerate(scores))


def _ms(start: float) -> float:
    return (perf_counter() - start) * 1000.0

"""Frame to verdict: locate, unwrap, quality gate, classify, decide. No device, no file."""

from time import perf_counter

import numpy as np

from station.classify.decision import findings, mean_of, near_threshold, rejected_kinds
from station.classify.drift import read_reference
from station.classify.onnx import LOOK, Classifier, RingNetwork
from station.classify.thresholds import in_use
from station.defects import Reason
from station.domain import Image, Inspection, Ring, SegmentScores, Timing, Verdict
from station.errors import LocateError, ModelError
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from station.vision.locate import Expected, locate
from station.vision.quality import gate, measure
from station.vision.unwrap import segments, unwrap

LOOK_DECIMALS = 3
"""Of a part's look; its components are about 1."""


class Inspector:
    """Judges frames with one model and one set of limits; the same for line and replay."""

    def __init__(
        self,
        ring_network: RingNetwork,
        classifier: Classifier,
        weld: WeldSettings,
        quality: QualitySettings,
        model: ModelSettings,
    ) -> None:
        """Raises ModelError if the settings name a reference that does not fit, SettingsError if a limit is of no kind the model knows."""
        self._ring_network = ring_network
        self.classifier = classifier
        self._weld = weld
        self._quality = quality
        px_per_mm = 1000.0 / weld.um_per_px
        self._expected = Expected(weld.radius_mm * px_per_mm, weld.radius_tolerance_mm * px_per_mm)
        self.card = card = classifier.card
        path = model.reference_path
        self.reference = None if path is None else read_reference(path, card.file_hash, LOOK)
        self.thresholds = in_use(card.thresholds, model.limits, model.segment_thresholds)

    def locate(self, image: Image) -> Ring:
        """Ring of the weld in `image` (H, W) uint8. Raises LocateError, ModelError."""
        return locate(image, self._expected, self._ring_network)

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
        found = findings(scores, judged.maps, judged.mapped, self.thresholds, ring, self._weld.um_per_px)
        rejected = rejected_kinds(scores, found, self.thresholds)
        reasons = sorted({kind for kind in rejected if kind is not None}, key=lambda kind: kind.code)
        worst = max((f for f in found if f.kind in reasons), key=lambda f: f.score, default=None)
        return Inspection(
            verdict=Verdict.NOK if reasons else Verdict.OK,
            reason=next(iter(reasons), None) if worst is None else worst.kind,
            ring=ring,
            quality=quality,
            scores=scores,
            findings=found,
            rejected=rejected,
            timing=Timing(grab_ms, locate_ms, unwrap_ms, _ms(start)),
            novelty=judged.novelty,
            look=tuple(np.round(judged.looks.mean(axis=0, dtype=np.float64), LOOK_DECIMALS).tolist()),
        )

    def _look_twice(self, crops: Image, scores: tuple[SegmentScores, ...]) -> tuple[SegmentScores, ...]:
        """Segments near their threshold are seen again in the mirror: a mirrored weld is a weld, with the same defects."""
        near = [i for i, s in enumerate(scores) if near_threshold(s, self.thresholds.of_segment(i))]
        if not near:
            return scores
        again = crops[near]
        views = np.concatenate([again[:, :, ::-1], again[:, ::-1], again[:, ::-1, ::-1]])
        mirrored = self.classifier(views).scores
        seen = {segment: (scores[segment], *mirrored[i :: len(near)]) for i, segment in enumerate(near)}
        return tuple(mean_of(seen[i]) if i in seen else s for i, s in enumerate(scores))


def _ms(start: float) -> float:
    return (perf_counter() - start) * 1000.0

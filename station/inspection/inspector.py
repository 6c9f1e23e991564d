"""Judges a frame: locate, unwrap, check what was seen, classify, decide. Uses no device and no file."""

from dataclasses import replace
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from station.classify.decision import findings, mean_of, near_threshold, rejected_kinds
from station.classify.drift import read_reference
from station.classify.onnx import APPEARANCE_SIZE
from station.classify.thresholds import in_use
from station.defects import Reason
from station.domain import Image, Inspection, Ring, SegmentScores, Timing, Verdict
from station.errors import LocateError, ModelError
from station.inspection.networks import Networks
from station.inspection.verdict import Novelty, decide
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from station.settings.view import view_problem
from station.vision.locate import Expected, Located, locate
from station.vision.quality import gate, measure
from station.vision.seen import causes, hidden_columns, measure_segments, visible_fractions
from station.vision.unwrap import segments, unwrap

APPEARANCE_DECIMALS = 3
"""Decimals to which a part's appearance features, which are about 1, are rounded."""


class Inspector:
    """Judges frames with one set of networks and one set of limits."""

    def __init__(
        self,
        networks: Networks,
        *,
        weld: WeldSettings,
        quality: QualitySettings,
        model: ModelSettings,
    ) -> None:
        """Set up the limits and read the reference.

        Raises ModelError if the reference does not match the classifier, SettingsError if the settings limit
        a kind of defect that the classifier does not know.
        """
        self._ring_network = networks.ring
        self._seen_network = networks.seen
        self.classifier = networks.classifier
        self._weld = weld
        self._quality = quality
        self._novel = model.novel
        self._expected = Expected(weld.radius_mm, weld.radius_tolerance_mm)
        self.card = card = networks.classifier.card
        path = model.reference_path
        self.reference = None if path is None else read_reference(path, card.file_hash, APPEARANCE_SIZE)
        self.thresholds = in_use(card.thresholds, model.limits, model.segment_thresholds)

    @property
    def um_per_px(self) -> float:
        """Scale of the images that are judged."""
        return self._weld.um_per_px

    def view_problem(self, image: Image) -> str | None:
        """Return why the weld cannot be wholly in view in an image of this size, or None if it can be."""
        height, width = image.shape
        return view_problem(self._weld, width, height)

    def locate(self, image: Image) -> Ring:
        """Return the ring of the weld in `image` (height, width) uint8. Raises LocateError, ModelError."""
        return self._located(image).ring

    def _located(self, image: Image) -> Located:
        """Return the ring in pixels of the image, and where weld or joint lies on it."""
        return locate(image, self._expected, self._ring_network, um_per_px=self.um_per_px)

    def is_novel(self, judged: Inspection) -> bool:
        """Return whether a part differs from all training images, so that its verdict is less reliable."""
        return judged.novelty is not None and judged.novelty > self.card.novelty_limit

    def inspect(self, image: Image, grab_ms: float | None = None) -> Inspection:
        """Return the inspection of `image` (height, width) uint8; OK only if all 21 were seen and judged."""
        start = perf_counter()
        try:
            located = self._located(image)
        except LocateError as error:
            reason = Reason.WELD_OUT_OF_VIEW if error.out_of_view else Reason.NO_WELD_FOUND
            return Inspection.error(reason, timing=Timing(grab_ms, _ms(start)), detail=str(error))
        except ModelError as error:
            return Inspection.error(
                Reason.MODEL_FAILED, timing=Timing(grab_ms, _ms(start)), detail=str(error)
            )
        ring, locate_ms, start = located.ring, _ms(start), perf_counter()
        strip = unwrap(image, ring, um_per_px=self.um_per_px)
        crops = segments(strip)
        quality = measure(strip)
        unwrap_ms, start = _ms(start), perf_counter()
        timing = Timing(grab_ms, locate_ms, unwrap_ms)
        try:
            hidden = hidden_columns(strip, self._seen_network)
        except ModelError as error:
            return Inspection.error(Reason.MODEL_FAILED, ring, quality, timing, detail=str(error))
        seen = measure_segments(crops, located.presence, visible_fractions(hidden))
        not_judged = Inspection(
            Verdict.ERROR,
            Reason.MODEL_FAILED,
            ring=ring,
            quality=quality,
            segment_quality=seen,
            unseen=causes(seen, self._quality),
            timing=timing,
        )
        unfit = gate(quality, self._quality)
        if unfit is not None:
            return replace(not_judged, reason=unfit[0], detail=unfit[1])
        try:
            judged = self.classifier(crops)
            scores = self._average_mirrored(crops, judged.scores)
        except ModelError as error:
            return replace(not_judged, detail=str(error))
        um_per_px = self.um_per_px
        found = findings(scores, judged.maps, judged.mapped, self.thresholds, ring=ring, um_per_px=um_per_px)
        rejected = rejected_kinds(scores, found, self.thresholds)
        novelty = Novelty(judged.novelty, self.card.novelty_limit, self._novel)
        verdict, why, detail = decide(rejected, found, seen, limits=self._quality, novelty=novelty)
        return replace(
            not_judged,
            verdict=verdict,
            reason=why,
            detail=detail,
            scores=scores,
            findings=found,
            rejected=rejected,
            timing=Timing(grab_ms, locate_ms, unwrap_ms, _ms(start)),
            novelty=judged.novelty,
            look=_mean_appearance(judged.appearances),
        )

    def _average_mirrored(self, crops: Image, scores: tuple[SegmentScores, ...]) -> tuple[SegmentScores, ...]:
        """Return the scores; those near a threshold are averaged over the mirror images of their crop.

        A mirrored weld is also a weld, with the same defects.
        """
        near = [i for i, own in enumerate(scores) if near_threshold(own, self.thresholds.of_segment(i))]
        if not near:
            return scores
        chosen = crops[near]
        views = np.concatenate([chosen[:, :, ::-1], chosen[:, ::-1], chosen[:, ::-1, ::-1]])
        mirrored = self.classifier(views).scores
        seen = {segment: (scores[segment], *mirrored[i :: len(near)]) for i, segment in enumerate(near)}
        return tuple(mean_of(seen[i]) if i in seen else own for i, own in enumerate(scores))


def _mean_appearance(appearances: NDArray[np.float32]) -> tuple[float, ...]:
    return tuple(np.round(appearances.mean(axis=0, dtype=np.float64), APPEARANCE_DECIMALS).tolist())


def _ms(start: float) -> float:
    return (perf_counter() - start) * 1000.0

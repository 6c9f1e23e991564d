"""A recipe made ready: networks loaded and warm, limits set, tested on a stored frame."""

import hashlib
import zlib
from dataclasses import dataclass, replace

from station import __version__
from station.classify.onnx import Classifier, RingNetwork
from station.inspection import Inspector
from station.records import Provenance
from station.selftest import SelfTest
from station.settings import Settings, for_recipe


@dataclass(frozen=True, slots=True)
class Loaded:
    """A recipe, ready to judge."""

    number: int
    inspector: Inspector
    provenance: Provenance
    self_test: SelfTest | None


def prepare(settings: Settings, number: int) -> Loaded:
    """Load a recipe, warm it up, test it on its stored frame. Raises WeldgateError."""
    chosen = for_recipe(settings, number)
    inspector, provenance = load_inspector(chosen)
    provenance = replace(provenance, recipe=number)
    path = chosen.model.self_test_path
    return Loaded(number, inspector, provenance, None if path is None else SelfTest(inspector, path, str(chosen.model.self_test_verdict)))


def load_inspector(settings: Settings) -> tuple[Inspector, Provenance]:
    """Inspector and what its verdicts come from. Raises ModelError."""
    ring_network = RingNetwork(settings.model.ring_path, settings.model.threads)
    classifier = Classifier(settings.model.path, settings.model.threads)
    inspector = Inspector(ring_network, classifier, settings.weld, settings.quality, settings.model)
    parts = (
        settings.model_dump_json(include={"camera", "weld", "quality"}),
        ring_network.file_hash,
        classifier.card.file_hash,
        str(inspector.thresholds),
    )
    provenance = Provenance(
        software=__version__,
        model_version=classifier.card.version,
        model_hash=classifier.card.file_hash,
        ring_model_hash=ring_network.file_hash,
        config_crc=zlib.crc32("".join(parts).encode()) & 0xFFFF,
        hole_threshold=inspector.thresholds.hole,
        missing_threshold=inspector.thresholds.missing_weld,
        segment_thresholds=inspector.thresholds.segments,
        hole_min_mm=inspector.thresholds.hole_min_mm,
        missing_min_mm=inspector.thresholds.missing_min_mm,
        limits_hash=hashlib.sha256(settings.model_dump_json(include={"weld", "quality"}).encode()).hexdigest(),
    )
    return inspector, provenance

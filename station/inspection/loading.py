"""Prepares a recipe for inspection: loads its networks, sets its limits and runs its self-test."""

import hashlib
import logging
import zlib
from dataclasses import dataclass, replace

from station import __version__
from station.classify.thresholds import Thresholds
from station.defects import KINDS
from station.errors import ImageError, ModelError
from station.files.installation import SHIPPED_GOOD_FRAME
from station.inspection.inspector import Inspector
from station.inspection.networks import load_networks
from station.inspection.self_test import SelfTest
from station.records import Provenance
from station.settings.model import ModelSettings, Settings, for_recipe

log = logging.getLogger("weldgate.loading")

OWN_FRAME = "set model.self_test_path to a frame of an own good part"
"""What to do if the shipped frame does not fit the weld."""


@dataclass(frozen=True, slots=True)
class Loaded:
    """A recipe that is ready to judge frames."""

    number: int
    inspector: Inspector
    provenance: Provenance
    self_test: SelfTest | None


def prepare(settings: Settings, number: int) -> Loaded:
    """Load a recipe, warm up its networks and run its self-test. Raises WeldgateError."""
    chosen = for_recipe(settings, number)
    inspector, provenance = load_inspector(chosen)
    provenance = replace(provenance, recipe=number)
    if unknown := _not_judged(inspector.thresholds):
        log.warning(
            "%s does not know %s: parts with it can read OK; train a network that knows it",
            chosen.model.path,
            ", ".join(unknown),
        )
    return Loaded(number, inspector, provenance, _self_test(inspector, chosen.model))


def _self_test(inspector: Inspector, model: ModelSettings) -> SelfTest | None:
    """Return the self-test on the frame of the settings or, without one, on a shipped frame if that fits."""
    if model.self_test_path is not None:
        return SelfTest(inspector, model.self_test_path, str(model.self_test_verdict))
    try:
        return SelfTest(inspector, SHIPPED_GOOD_FRAME)
    except (ImageError, ModelError) as error:
        log.warning("there is no self-test: %s; %s", error, OWN_FRAME)
        return None


def load_inspector(settings: Settings) -> tuple[Inspector, Provenance]:
    """Return the inspector of these settings and the provenance of its verdicts. Raises ModelError."""
    networks = load_networks(settings.model)
    inspector = Inspector(networks, weld=settings.weld, quality=settings.quality, model=settings.model)
    card = networks.classifier.card
    parts = (
        settings.model_dump_json(include={"camera": True, "weld": True, "quality": True, "model": {"novel"}}),
        networks.ring.file_hash,
        networks.seen.file_hash,
        card.file_hash,
        *_words_of(inspector.thresholds),
    )
    provenance = Provenance(
        software=__version__,
        model_version=card.version,
        model_hash=card.file_hash,
        ring_model_hash=networks.ring.file_hash,
        seen_model_hash=networks.seen.file_hash,
        config_crc=zlib.crc32("".join(parts).encode()) & 0xFFFF,
        thresholds=inspector.thresholds,
        limits_hash=hashlib.sha256(
            settings.model_dump_json(include={"weld": True, "quality": True, "model": {"novel"}}).encode()
        ).hexdigest(),
        um_per_px=settings.weld.um_per_px,
    )
    return inspector, provenance


def _not_judged(thresholds: Thresholds) -> list[str]:
    """Return the kinds of defect that the station knows and its classifier does not."""
    known = [limit.kind for limit in thresholds.kinds]
    return [str(kind.reason) for kind in KINDS if kind not in known]


def _words_of(thresholds: Thresholds) -> list[str]:
    """Return all limits as text, so that a change of any limit changes CONFIG_CRC."""
    words = [f"{limit.kind.name} {limit.threshold!r} {limit.min_mm!r}" for limit in thresholds.kinds]
    return words + [f"{number} {own!r}" for number, own in thresholds.segments]

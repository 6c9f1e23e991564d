"""The networks of a station: what finds the weld, what says whether it is seen, and what judges it."""

from dataclasses import dataclass

from station.classify.onnx import Classifier, RingNetwork, SeenNetwork
from station.settings.model import ModelSettings


@dataclass(frozen=True, slots=True, eq=False)
class Networks:
    """Loaded networks."""

    ring: RingNetwork
    seen: SeenNetwork
    classifier: Classifier


def load_networks(model: ModelSettings) -> Networks:
    """Load and warm up the networks that the settings name. Raises ModelError."""
    return Networks(
        ring=RingNetwork(model.ring_path, model.threads),
        seen=SeenNetwork(model.seen_path, model.threads),
        classifier=Classifier(model.path, model.threads),
    )

"""The networks of a station: what finds the weld, what says whether it is seen, and what judges it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from station.classify.onnx import Classifier, RingNetwork, SeenNetwork
from station.errors import ModelError
from station.settings.model import ModelSettings

AnyNetwork = TypeVar("AnyNetwork")


@dataclass(frozen=True, slots=True, eq=False)
class Networks:
    """Loaded networks."""

    ring: RingNetwork
    seen: SeenNetwork
    classifier: Classifier


def load_networks(model: ModelSettings) -> Networks:
    """Load and warm up the networks that the settings name. Raises ModelError, which names the setting."""
    return Networks(
        ring=_loaded(RingNetwork, "model.ring_path", model.ring_path, model.threads),
        seen=_loaded(SeenNetwork, "model.seen_path", model.seen_path, model.threads),
        classifier=_loaded(Classifier, "model.path", model.path, model.threads),
    )


def _loaded(load: Callable[[Path, int], AnyNetwork], key: str, path: Path, threads: int) -> AnyNetwork:
    try:
        return load(path, threads)
    except ModelError as error:
        raise ModelError(f"{key}: {error}") from None

import pytest

from station.classify.onnx import Classifier, RingNetwork
from station.inspection.inspector import Inspector
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from tests.conftest import MODEL, RING_MODEL


@pytest.fixture(scope="session")
def classifier() -> Classifier:
    """The shipped model."""
    return Classifier(MODEL)


@pytest.fixture(scope="session")
def ring_network() -> RingNetwork:
    """The shipped ring network."""
    return RingNetwork(RING_MODEL)


@pytest.fixture(scope="session")
def inspector(ring_network: RingNetwork, classifier: Classifier) -> Inspector:
    """The shipped model with default limits."""
    return Inspector(
        ring_network, classifier, weld=WeldSettings(), quality=QualitySettings(), model=ModelSettings()
    )

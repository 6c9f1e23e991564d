import pytest

from station.classify.onnx import Classifier
from station.inspection.inspector import Inspector
from station.inspection.networks import Networks, load_networks
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from tests.conftest import NETWORKS


@pytest.fixture(scope="session")
def networks() -> Networks:
    """The shipped networks."""
    return load_networks(NETWORKS)


@pytest.fixture(scope="session")
def classifier(networks: Networks) -> Classifier:
    """The shipped model."""
    return networks.classifier


@pytest.fixture(scope="session")
def inspector(networks: Networks) -> Inspector:
    """The shipped model with default limits."""
    return Inspector(networks, weld=WeldSettings(), quality=QualitySettings(), model=ModelSettings())

from pathlib import Path

import numpy as np
import pytest
import torch

from models.classifier import export as export_file
from models.classifier.export import Contract, export, read_network
from models.classifier.network import STATISTICS, WeldNet
from models.errors import LearningError
from station.classify.onnx import CLASSES, Classifier
from tests.conftest import RING_MODEL
from tests.models.made import limits


def contract() -> Contract:
    return Contract(
        version="1.2",
        data_hash="d" * 64,
        thresholds=limits(hole=0.3, missing_weld=0.2),
        mean=np.random.default_rng(1).normal(size=STATISTICS),
        whitening=np.eye(STATISTICS) * 0.5,
        novelty_limit=2.5,
        prior_shift=(0.5, *np.linspace(-1.0, -0.5, len(CLASSES) - 1).tolist()),
    )


def trained() -> WeldNet:
    """Random weights, and running means that are not those of a fresh network."""
    torch.manual_seed(1)
    network = WeldNet().train()
    with torch.no_grad():
        network(torch.randint(0, 256, (8, 1, 128, 128), dtype=torch.uint8))
    return network.eval()


def test_the_file_answers_like_the_network(tmp_path: Path) -> None:
    network, says = trained(), contract()
    export(network, tmp_path / "a.onnx", says)
    classifier = Classifier(tmp_path / "a.onnx")
    card = classifier.card
    assert (card.version, card.thresholds, card.novelty_limit) == (
        "1.2",
        limits(hole=0.3, missing_weld=0.2),
        2.5,
    )
    crops = np.random.default_rng(5).integers(0, 256, (3, 128, 128), dtype=np.uint8)
    with torch.no_grad():
        logits, where, features = network(torch.from_numpy(crops[:, None]))
    judged = classifier(crops)
    expected = torch.softmax(logits + torch.tensor(says.prior_shift), 1).numpy()
    assert np.array([(s.ok, *s.defects.values()) for s in judged.scores]) == pytest.approx(expected, abs=1e-4)
    assert judged.maps == pytest.approx(torch.sigmoid(where).numpy(), abs=1e-4)
    away = (features.numpy() - says.mean) @ says.whitening
    assert judged.appearances == pytest.approx(away, rel=1e-3, abs=1e-3)


def test_the_network_comes_back_from_its_file(tmp_path: Path) -> None:
    network = trained()
    export(network, tmp_path / "a.onnx", contract())
    crops = torch.randint(0, 256, (3, 1, 128, 128), dtype=torch.uint8)
    with torch.no_grad():
        assert torch.allclose(network(crops)[0], read_network(tmp_path / "a.onnx")(crops)[0], atol=1e-4)


def test_only_a_classifier_can_be_trained_further() -> None:
    with pytest.raises(Exception, match=r"ring\.onnx: not a weldgate classifier"):
        read_network(RING_MODEL)


def test_a_file_that_differs_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export_file, "TOLERANCE", -1.0)
    with pytest.raises(LearningError, match="nothing kept"):
        export(WeldNet(), tmp_path / "a.onnx", contract())
    assert list(tmp_path.iterdir()) == []


def test_brightness_and_contrast_are_taken_out_inside_the_graph() -> None:
    network = trained()
    crop = torch.from_numpy(np.random.default_rng(5).integers(40, 100, (1, 1, 128, 128), dtype=np.uint8))
    with torch.no_grad():
        assert torch.allclose(network(crop)[0], network(crop * 2)[0], atol=0.15)

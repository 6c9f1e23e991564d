from pathlib import Path

import numpy as np
import pytest
import torch

from models import export as export_file
from models.errors import LearningError
from models.export import export, export_ring
from models.network import WeldNet
from models.ring import RingNet
from station.classify.onnx import Classifier, RingNetwork


def test_the_file_answers_like_the_network(tmp_path: Path) -> None:
    torch.manual_seed(1)
    network = WeldNet()
    export(network, tmp_path / "a.onnx", "1.2", "d" * 64, 0.3, 0.2)
    classifier = Classifier(tmp_path / "a.onnx")
    assert (classifier.card.version, classifier.card.hole_threshold, classifier.card.missing_threshold) == ("1.2", 0.3, 0.2)
    crops = np.random.default_rng(5).integers(0, 256, (3, 128, 128), dtype=np.uint8)
    with torch.no_grad():
        wanted = torch.softmax(network.eval()(torch.from_numpy(crops[:, None])), dim=1).numpy()
    assert np.array([(s.ok, s.hole, s.missing_weld) for s in classifier(crops)]) == pytest.approx(wanted, abs=1e-4)


def test_the_ring_file_answers_like_the_network(tmp_path: Path) -> None:
    torch.manual_seed(1)
    export_ring(RingNet(), tmp_path / "r.onnx", "1", "d" * 64)
    offset, presence = RingNetwork(tmp_path / "r.onnx")(np.zeros((192, 672), np.uint8))
    assert offset.shape == presence.shape == (84,)


def test_a_file_that_differs_is_not_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export_file, "TOLERANCE", -1.0)
    with pytest.raises(LearningError, match="nothing kept"):
        export(WeldNet(), tmp_path / "a.onnx", "1", "d", 0.5, 0.5)
    assert list(tmp_path.iterdir()) == []


def test_brightness_and_contrast_are_taken_out_inside_the_graph() -> None:
    torch.manual_seed(0)
    network = WeldNet().eval()
    crop = torch.from_numpy(np.random.default_rng(5).integers(40, 100, (1, 1, 128, 128), dtype=np.uint8))
    with torch.no_grad():
        assert torch.allclose(network(crop), network(crop * 2), atol=0.15)

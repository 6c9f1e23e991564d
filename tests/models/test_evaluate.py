from pathlib import Path

from models.evaluate import evaluate
from station.classify.onnx import Classifier, RingNetwork
from station.inspection import Inspector
from station.settings import ModelSettings, QualitySettings, WeldSettings
from tests.conftest import MODEL, RING_MODEL
from tests.parts import FRAMES, labels


def test_the_shipped_frames_are_evaluated_right(tmp_path: Path) -> None:
    (tmp_path / "frames").symlink_to(FRAMES)
    (tmp_path / "labels.json").symlink_to(FRAMES / "labels.json")
    inspector = Inspector(RingNetwork(RING_MODEL), Classifier(MODEL), WeldSettings(), QualitySettings(), ModelSettings())
    outcome = evaluate(tmp_path, inspector, lambda: None)
    assert (outcome.parts, outcome.right, outcome.escapes, outcome.not_judged) == (len(labels()), len(labels()), [], [])
    assert outcome.segments["tp"] > 20
    assert max(outcome.center_error_px) < 1.0
    assert "0 escapes" in outcome.lines()[0]

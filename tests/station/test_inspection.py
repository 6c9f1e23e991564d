import re
from dataclasses import replace

import numpy as np
import pytest

from station.classify.onnx import Classifier, Judged
from station.defects import Reason
from station.domain import SEGMENTS, Image, Inspection, Unseen, Verdict
from station.errors import ModelError
from station.inspection.inspector import Inspector
from station.inspection.networks import Networks
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from tests.parts import label_with, labels, ok_inspection, segment_quality


def test_shipped_frames_are_judged_right(frames: dict[str, Image], inspector: Inspector) -> None:
    for item in labels():
        judged = inspector.inspect(frames[item["frame"]])
        assert judged.verdict == item["verdict"], item["frame"]
        assert len(judged.scores) == SEGMENTS
        wanted = {"OK": None, "hole": Reason.HOLE, "missing_weld": Reason.MISSING_WELD}[item["truth"]]
        assert judged.reason == wanted


def test_findings_touch_the_true_defects(frames: dict[str, Image], inspector: Inspector) -> None:
    item = label_with("missing_weld")
    found = inspector.inspect(frames[item["frame"]]).findings
    for defect in item["defects"]:
        middle = sum(defect["angle_deg"]) / 2
        assert any(f.start_deg <= middle + turn <= f.end_deg for f in found for turn in (-360, 0, 360))


def test_a_hole_is_measured_where_it_is(frames: dict[str, Image], inspector: Inspector) -> None:
    item = label_with("hole")
    measured = [f for f in inspector.inspect(frames[item["frame"]]).findings if f.width_mm is not None]
    assert measured
    for defect in item["defects"]:
        middle = sum(defect["angle_deg"]) / 2
        near = [
            f
            for f in measured
            if any(f.start_deg - 1 <= middle + turn <= f.end_deg + 1 for turn in (-360, 0, 360))
        ]
        assert near, defect
        assert min(abs(f.length_mm - defect["length_mm"]) for f in near) < 0.15


def test_a_part_unlike_the_training_images_is_told(frames: dict[str, Image], inspector: Inspector) -> None:
    judged = inspector.inspect(frames[label_with("OK")["frame"]])
    assert judged.novelty is not None
    assert not inspector.is_novel(judged)
    assert inspector.is_novel(replace(judged, novelty=inspector.card.novelty_limit * 1.01))
    assert not inspector.is_novel(Inspection.error(Reason.CAMERA_LOST))


def test_same_frame_same_answer_to_the_bit(frames: dict[str, Image], inspector: Inspector) -> None:
    image = frames[labels()[0]["frame"]]
    first, second = inspector.inspect(image), inspector.inspect(image)
    assert (first.ring, first.scores, first.findings) == (second.ring, second.scores, second.findings)


@pytest.mark.parametrize(
    ("gain", "reason"),
    [(0.02, {Reason.TOO_DARK, Reason.NO_WELD_FOUND}), (40.0, {Reason.TOO_BRIGHT, Reason.NO_WELD_FOUND})],
)
def test_wrong_exposure_is_not_judged(
    gain: float, reason: set[Reason], frames: dict[str, Image], inspector: Inspector
) -> None:
    image = np.asarray(np.clip(frames[label_with("OK")["frame"]] * gain, 0, 255), np.uint8)
    judged = inspector.inspect(image)
    assert judged.verdict is Verdict.ERROR
    assert judged.reason in reason
    assert judged.detail is not None
    assert re.search(r"\d", judged.detail), "with the numbers"


def test_a_failing_model_is_never_ok(
    frames: dict[str, Image],
    networks: Networks,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(_self: Classifier, _crops: Image) -> Judged:
        raise ModelError("out of memory")

    inspector = Inspector(networks, weld=WeldSettings(), quality=QualitySettings(), model=ModelSettings())
    monkeypatch.setattr(Classifier, "__call__", fail)
    judged = inspector.inspect(frames[label_with("OK")["frame"]])
    assert (judged.verdict, judged.reason) == (Verdict.ERROR, Reason.MODEL_FAILED)
    assert judged.detail == "out of memory"


@pytest.mark.parametrize(
    "change",
    [
        {"scores": ()},
        {"scores": ok_inspection().scores[:20]},
        {"ring": None},
        {"reason": Reason.HOLE},
        {"rejected": (Reason.HOLE,) * 21},
        {"unseen": ()},
        {"unseen": (None,) * 20 + (Unseen.COVERED,)},
    ],
)
def test_ok_cannot_be_made_from_less_than_21_segments(change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="21 judged segments"):
        replace(ok_inspection(), **change)  # type: ignore[arg-type]


@pytest.mark.parametrize("change", [{"unseen": (None,) * 20}, {"segment_quality": (segment_quality(),)}])
def test_what_was_seen_is_known_of_all_segments_or_of_none(change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match="needed 0 or 21"):
        replace(ok_inspection(), verdict=Verdict.ERROR, **change)  # type: ignore[arg-type]


def test_errors_carry_no_scores() -> None:
    assert Inspection.error(Reason.CAMERA_LOST).scores == ()

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

import models.classifier.train
from models.__main__ import main
from models.classifier.export import read_network
from models.classifier.train import fine_tune
from models.data.labelled import read_lot
from models.errors import LearningError
from models.evaluation.drift import DRIFTS, STRENGTHS, drift, write_drift
from models.evaluation.evaluate import evaluate_lot
from models.evaluation.first_day import first_day
from models.evaluation.report import lines, summary, write_report
from station.classify.drift import Reference, read_reference
from station.classify.onnx import APPEARANCE_SIZE
from station.inspection.inspector import Inspector
from station.inspection.networks import load_networks
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from station.vision.unwrap import segments
from tests.conftest import MODEL, NETWORKS
from tests.parts import FRAMES, label_with, labels


@pytest.fixture(scope="module")
def inspector() -> Inspector:
    return Inspector(
        load_networks(NETWORKS),
        weld=WeldSettings(),
        quality=QualitySettings(),
        model=ModelSettings(),
    )


@pytest.fixture
def lot(tmp_path: Path) -> Path:
    folder = tmp_path / "lot"
    folder.mkdir()
    (folder / "frames").symlink_to(FRAMES)
    (folder / "labels.json").symlink_to(FRAMES / "labels.json")
    return folder


def test_the_shipped_frames_are_evaluated_right(lot: Path, inspector: Inspector, tmp_path: Path) -> None:
    found = evaluate_lot(lot, inspector)
    figures = summary(found)
    parts = figures["parts"]
    assert (parts["count"], parts["right"], parts["escapes"], parts["not_judged"]) == (
        len(labels()),
        len(labels()),
        [],
        [],
    )
    assert figures["segments"]["tp"] > 20
    assert parts["center_error_px"][1] < 6.0
    assert "0 escapes" in lines(found)[0]
    assert sum(row["of"] for row in figures["defects"]) == sum(len(item["defects"]) for item in labels())
    write_report(found, tmp_path / "report", "four parts", {"data": "shipped"})
    assert (tmp_path / "report" / "report.html").stat().st_size > 50_000


def test_an_unreadable_frame_is_named_before_any_is_judged(
    lot: Path, inspector: Inspector, tmp_path: Path
) -> None:
    (lot / "frames").unlink()
    (lot / "frames").mkdir()
    for item in labels():
        (lot / "frames" / item["frame"]).write_bytes(b"")
    with pytest.raises(LearningError, match=f"{len(labels())} wrong"):
        evaluate_lot(lot, inspector)


def test_drifts_begin_with_the_lot_as_it_is(lot: Path, inspector: Inspector, tmp_path: Path) -> None:
    steps = drift(lot, inspector.classifier, None)
    assert len(steps) == len(DRIFTS) * len(STRENGTHS)
    untouched = [s for s in steps if s.strength == 0]
    assert len({(s.segments, s.alarms) for s in untouched}) == 1
    assert all(
        s.segments.f2 < untouched[0].segments.f2
        for s in steps
        if s.drift == "glass gets hazy" and s.strength == 1
    )
    write_drift(steps, tmp_path / "drift")
    assert len(json.loads((tmp_path / "drift" / "drift.json").read_text())) == len(steps)
    assert cv2.imread(str(tmp_path / "drift" / "drift.png")) is not None


def test_the_drift_of_one_part_from_its_own_appearance_is_reported(lot: Path, inspector: Inspector) -> None:
    strip = read_lot(lot)[0].strip
    look = inspector.classifier(segments(strip)).appearances.mean(axis=0, dtype=np.float64)
    file_hash = inspector.card.file_hash
    entries = json.loads((lot / "labels.json").read_text())["frames"]
    (lot / "labels.json").unlink()
    (lot / "labels.json").write_text(json.dumps({"frames": entries[:1]}))
    reference = Reference(
        model_hash=file_hash, parts=20, mean=tuple(look.tolist()), spread=(0.1,) * APPEARANCE_SIZE, limit=0.02
    )
    steps = drift(lot, inspector.classifier, reference)
    assert all(s.alarms == 0 for s in steps if s.strength == 0)
    assert all(s.alarms == 1 for s in steps if s.strength == 1)


def test_the_first_day_writes_a_reference_of_good_parts_only(
    inspector: Inspector, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    parts = 8
    monkeypatch.setattr("models.classifier.reference.MIN_PARTS", parts)
    image = cv2.imread(str(FRAMES / label_with("OK")["frame"]), cv2.IMREAD_GRAYSCALE)
    for i in range(parts):
        made = np.clip(image * (0.9 + 0.025 * i), 0, 255).astype(np.uint8)
        cv2.imwrite(str(tmp_path / f"{i:02d}.png"), made, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    assert main(["first-day", str(tmp_path), "--reference", str(tmp_path / "line.json")]) == 0
    assert f"reference: {tmp_path / 'line.json'}" in capsys.readouterr().out
    reference = read_reference(tmp_path / "line.json", inspector.card.file_hash, APPEARANCE_SIZE)
    assert reference.parts == parts
    settings = ModelSettings(reference_path=tmp_path / "line.json")
    watched = Inspector(
        load_networks(NETWORKS),
        weld=WeldSettings(),
        quality=QualitySettings(),
        model=settings,
    )
    assert watched.reference == reference
    (tmp_path / "bad.png").symlink_to(FRAMES / label_with("hole")["frame"])
    assert main(["first-day", str(tmp_path), "--reference", str(tmp_path / "second.json")]) == 1
    assert not (tmp_path / "second.json").exists()


def test_the_first_day_takes_ok_parts_and_names_others(inspector: Inspector) -> None:
    good = [FRAMES / label_with("OK")["frame"]]
    found = first_day(good, inspector, inspector.card.novelty_limit)
    assert found.good
    assert found.lines()[-1] == "ready"
    bad = first_day([*good, FRAMES / label_with("hole")["frame"]], inspector, inspector.card.novelty_limit)
    assert not bad.good
    assert any(label_with("hole")["frame"] in line and "rejected" in line for line in bad.lines())


def test_first_day_says_when_images_are_unlike_the_training(
    inspector: Inspector, capsys: pytest.CaptureFixture[str]
) -> None:
    found = first_day([FRAMES / label_with("OK")["frame"]], inspector, 0.01)
    assert not found.good
    assert any("unlike the training images" in line for line in found.lines())
    assert main(["first-day", str(FRAMES / label_with("hole")["frame"])]) == 1
    assert capsys.readouterr().out.endswith("not ready\n")


def test_a_shipped_network_can_be_trained_further_on_a_lines_own_parts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "line"
    (folder / "frames").mkdir(parents=True)
    entries = []
    for number in range(8):
        item = dict(labels()[number % 4])
        name = f"{number}.png"
        (folder / "frames" / name).symlink_to(FRAMES / item["frame"])
        entries.append({**item, "frame": name})
    (folder / "labels.json").write_text(json.dumps({"frames": entries}))
    monkeypatch.setattr(
        models.classifier.train,
        "FINE_TUNING",
        replace(models.classifier.train.FINE_TUNING, steps=6, batch=16),
    )
    out = tmp_path / "out"
    card = fine_tune(folder, model=MODEL, out=out, version="0.2-line", seed=0, report=print)
    assert card.provenance.startswith("Fine-tuned")
    assert card.held_out.f2 > 0.8
    before, after = read_network(MODEL), read_network(tmp_path / "out" / "weldgate.onnx")
    gaps = [
        float((a - b).detach().abs().max())
        for a, b in zip(before.parameters(), after.parameters(), strict=True)
    ]
    assert 0 < np.max(gaps) < 0.2

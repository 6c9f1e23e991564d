import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.__main__ import main
from models.classifier.card import card_json, card_text, read_card
from models.classifier.fit import fit
from models.classifier.network import WeldNet
from models.classifier.plan import Plan
from models.classifier.quantize import quantize
from models.classifier.train import train
from models.data.crops import DEFECTS, OK
from models.data.rendered import read_rendered
from models.errors import LearningError
from models.evaluation.detection import boxes, evaluate_boxes
from models.paper.train import PaperPlan, paper_scores, train_paper
from station.classify.onnx import Classifier
from tests import parts
from tests.conftest import MODEL
from tests.models.made import HOLE, MISSING, crops, dataset

SMALL = Plan(steps=80, batch=24, average=0.9, learning_rate=0.006)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dataset(tmp_path_factory.mktemp("data") / "made", 180)


@pytest.fixture(scope="module")
def run(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that has learned the made crops."""
    out = tmp_path_factory.mktemp("run")
    train([data], out=out, version="9.9", plan=SMALL, kinds=DEFECTS, report=print)
    return out


def test_a_run_learns_and_leaves_a_file_and_its_card(run: Path) -> None:
    card = json.loads((run / "run.json").read_text())
    assert card["held_out"]["f2"] > 0.9
    assert card["thresholds"]["hole"] <= 0.5
    text = (run / "CARD.md").read_text()
    assert "| version | 9.9 |" in text
    assert f"{card['held_out']['f2']:.4f}" in text
    classifier = Classifier(run / "weldgate.onnx")
    assert classifier.card.version == "9.9"
    assert classifier.card.novelty_limit == card["novelty_limit"]
    assert sorted(p.name for p in run.iterdir()) == ["CARD.md", "run.json", "weldgate.onnx"]


def test_the_shipped_card_is_that_of_its_run_and_of_its_file() -> None:
    card = read_card(MODEL.parent / "run.json")
    assert (MODEL.parent / "run.json").read_text() == card_json(card)
    assert (MODEL.parent / "CARD.md").read_text() == card_text(card)
    says = Classifier(MODEL).card
    of_file = (says.version, says.data_hash, says.novelty_limit)
    assert of_file == (card.version, card.data_hash, card.novelty_limit)
    assert {limit.kind.name: limit.threshold for limit in says.thresholds.kinds} == card.thresholds


@pytest.mark.parametrize(
    ("change", "problem"),
    [(None, "Invalid JSON"), ({"version": None}, "version: "), ({"versoin": "1"}, "versoin: ")],
)
def test_a_wrong_run_file_is_refused_in_one_line(
    change: dict[str, object] | None, problem: str, tmp_path: Path
) -> None:
    shipped = json.loads((MODEL.parent / "run.json").read_text())
    (tmp_path / "run.json").write_text("{" if change is None else json.dumps({**shipped, **change}))
    with pytest.raises(LearningError, match=f"run.json: not the card of a training run .*{problem}") as error:
        read_card(tmp_path / "run.json")
    assert "\n" not in str(error.value)


def test_the_map_shows_where_the_defect_is(run: Path) -> None:
    made = crops(30, seed=77)
    judged = Classifier(run / "weldgate.onnx")(made.images)
    for index in np.flatnonzero(made.labels == HOLE):
        row, column = np.unravel_index(judged.maps[index, 0].argmax(), (32, 32))
        assert made.maps[index, 0, row, column] > 0


def test_same_seed_same_network() -> None:
    made = crops(24)
    plan = replace(SMALL, steps=3)
    first, second, other = (_weights(made, replace(plan, seed=s)) for s in (1, 1, 2))
    assert (first == second).all()
    assert (first != other).any()


def _weights(made, plan: Plan) -> np.ndarray:  # type: ignore[no-untyped-def, type-arg]
    import torch

    torch.manual_seed(plan.seed)
    network = fit(WeldNet(), made, plan, lambda _: None)
    return np.concatenate([p.detach().numpy().ravel() for p in network.parameters()])


def test_one_kind_alone_can_be_learned(data: Path, tmp_path: Path) -> None:
    plan = replace(SMALL, steps=4)
    card = train([data], out=tmp_path, version="1", plan=plan, kinds=[HOLE], report=print)
    others = [label for label in DEFECTS if label != HOLE]
    assert [card.training_kinds[label] for label in others] == [0] * len(others)
    assert [card.plan.shares[label] for label in others] == [0] * len(others)
    assert sum(card.plan.shares) == pytest.approx(1)


def test_a_plan_that_does_not_fit_the_crops_is_refused() -> None:
    made = crops(24)
    without = made.pick(made.labels != HOLE)
    with pytest.raises(
        LearningError, match=r"^0 crops show hole, but its fraction of a batch is 0\.[0-9]+\. "
    ):
        fit(WeldNet(), without, SMALL, print)
    kinds = [label for label in DEFECTS if label != HOLE]
    with pytest.raises(
        LearningError, match=r"^[1-9]\d* crops show hole, but its fraction of a batch is 0\. "
    ):
        fit(WeldNet(), made, SMALL.limited_to(kinds), print)
    unknown_on_a_line = replace(
        SMALL, shares=(0.5, *(0.5 / len(kinds) if k != HOLE else 0.0 for k in DEFECTS))
    )
    with pytest.raises(LearningError, match="no crops of hole would be drawn"):
        unknown_on_a_line.limited_to([HOLE])


def test_boxes_lie_on_the_defects(run: Path, data: Path) -> None:
    held = read_rendered([data])[1]
    held = held.pick(np.isin(held.labels, (OK, HOLE, MISSING)))
    found = evaluate_boxes([data], held, Classifier(run / "weldgate.onnx"), (HOLE, MISSING))
    assert found.map50 > 0.8
    assert found.as_decision.recall > 0.9


def test_a_box_does_not_close_over_the_borders_of_a_crop() -> None:
    maps = np.zeros((2, 32, 32), np.float32)
    maps[0, 10:14, :4] = maps[0, 10:14, 28:] = 1
    assert sorted(b.box_px for b in boxes(maps, {parts.HOLE: 0.9, parts.MISSING_WELD: 0.1})) == [
        (0.0, 40.0, 16.0, 16.0),
        (112.0, 40.0, 16.0, 16.0),
    ]


def test_eight_bits_judge_alike_or_are_not_kept(run: Path, data: Path, tmp_path: Path) -> None:
    training, held, _ = read_rendered([data])
    f2 = quantize(run / "weldgate.onnx", tmp_path / "small.onnx", training, held)
    assert f2.int8 >= f2.float32 - 0.003
    assert Classifier(tmp_path / "small.onnx").card.version == "9.9"
    assert [p.name for p in tmp_path.iterdir()] == ["small.onnx"]
    black = training.pick(np.arange(40))
    black.images[:] = 0  # calibrated on black images the 8-bit file sees nothing
    with pytest.raises(LearningError, match="nothing kept"):
        quantize(run / "weldgate.onnx", tmp_path / "bad.onnx", black, held)
    assert [p.name for p in tmp_path.iterdir()] == ["small.onnx"]


def test_the_papers_protocol_ends_in_a_file_of_two_classes(data: Path, tmp_path: Path) -> None:
    card = train_paper([data], tmp_path, PaperPlan(epochs=1), lambda _: None)
    assert 1_400_000 < card.weights < 1_700_000
    run = json.loads((tmp_path / "run.json").read_text())
    assert run["plan"] == {"epochs": 1, "batch": 30, "learning_rate": 0.0005, "seed": 0}
    assert run["held_out"]["f2"] == card.held_out.f2
    scores = paper_scores(tmp_path / "paper.onnx", crops(5).images)
    assert scores.shape == (5,)
    assert ((scores >= 0) & (scores <= 1)).all()


def test_commands_train_judge_and_report(
    data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        main(["train", str(data), "--out", str(tmp_path / "runs"), "--seeds", "1", "2", "--steps", "5"]) == 0
    )
    assert "held-out f2" in capsys.readouterr().out
    model = str(tmp_path / "runs" / "seed-1" / "weldgate.onnx")
    assert (
        main(["evaluate", str(data), "--model", model, "--boxes", "--report", str(tmp_path / "report")]) == 0
    )
    assert "mAP50" in capsys.readouterr().out
    page = (tmp_path / "report" / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 2
    assert json.loads((tmp_path / "report" / "evaluation.json").read_text())["segments"]["tp"] >= 0


@pytest.mark.parametrize(
    "command",
    [
        ["train", "absent", "--out", "x"],
        ["evaluate", "absent"],
        ["fine-tune", "absent", "--out", "x"],
        ["first-day", "absent"],
    ],
)
def test_a_users_mistake_is_one_line(
    command: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / a) if a in ("absent", "x") else a for a in command]) == 2
    message = capsys.readouterr().err
    assert message.count("\n") == 1
    assert "absent" in message


@pytest.mark.parametrize(("option", "value"), [("--steps", "0"), ("--seeds", "-1")])
def test_numbers_out_of_range_are_refused_before_any_work(
    option: str, value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", str(tmp_path), "--out", str(tmp_path / "x"), option, value]) == 2
    assert capsys.readouterr().err.startswith(f"weldgate-models: {option} is {value}; ")

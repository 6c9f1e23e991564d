"""Script of test_third_kind.py: the learning room with a third kind of defect.

python -m tests.models.third_kind PLACE mapped|unmapped FOLDER
"""

import re
import sys
from collections.abc import Callable
from pathlib import Path

import station.defects
from station.defects import DefectKind, Reason

DENT = DefectKind(
    name="dent",
    reason=Reason.BLURRED,  # any reason that is not that of a defect
    color_rgb=(0, 200, 255),
    line_fraction=0.01,
    is_mapped=sys.argv[2] == "mapped",
)
OLD = station.defects.KINDS
PLACE = int(sys.argv[1])
station.defects.KINDS = (*OLD[:PLACE], DENT, *OLD[PLACE:])

# imported only now: everything is laid out for the kinds that are there at import
import numpy as np  # noqa: E402
import pytest  # noqa: E402

from models.__main__ import main  # noqa: E402
from models.classifier.card import read_card  # noqa: E402
from models.classifier.export import read_network  # noqa: E402
from models.classifier.plan import Plan  # noqa: E402
from models.classifier.train import train  # noqa: E402
from models.data.crops import CHANNELS, DEFECTS, OK, Crops  # noqa: E402
from models.data.rendered import read_rendered  # noqa: E402
from models.errors import LearningError  # noqa: E402
from models.evaluation.detection import evaluate_boxes  # noqa: E402
from models.evaluation.evaluate import evaluate_crops, evaluate_lot  # noqa: E402
from models.evaluation.measures import decided  # noqa: E402
from models.evaluation.report import summary  # noqa: E402
from models.evaluation.scores import class_scores  # noqa: E402
from station.classify.onnx import CLASSES, MAPPED, Classifier, Judged  # noqa: E402
from station.domain import SegmentScores  # noqa: E402
from station.inspection.inspector import Inspector  # noqa: E402
from station.inspection.networks import load_networks  # noqa: E402
from station.settings.model import ModelSettings, QualitySettings, WeldSettings  # noqa: E402
from tests.conftest import MODEL, NETWORKS  # noqa: E402
from tests.models.made import crops, dataset  # noqa: E402
from tests.parts import FRAMES, labels  # noqa: E402

THREE = ["ok", *(kind.name for kind in station.defects.KINDS)]
TWO = ["ok", *(kind.name for kind in OLD)]


class Truthful:
    """A classifier that says what the crops it is given show, of the kinds that it knows."""

    def __init__(self, crops: Crops) -> None:
        self._crops, self._next = crops, 0

    def __call__(self, images: object) -> Judged:
        here = slice(self._next, self._next + len(np.asarray(images)))
        self._next = here.stop
        kinds = station.defects.KINDS
        scores = [
            SegmentScores(float(label == OK), {kind: float(label == i) for i, kind in enumerate(kinds, 1)})
            for label in self._crops.labels[here]
        ]
        maps = self._crops.maps[here].astype(np.float32) / 255
        return Judged(tuple(scores), maps, MAPPED, np.zeros((len(scores), 192), np.float32))


def refused(work: Callable[[], object], reason: str) -> None:
    """Check that work is refused with that reason."""
    with pytest.raises(LearningError, match=re.escape(reason)):
        work()


def check_new_data(folder: Path) -> None:
    """Train, export, evaluate and read back with three kinds."""
    data = dataset(folder / "three", 36 * len(THREE))
    plan = Plan(steps=4, batch=8)
    card = train([data], out=folder / "run", version="1", plan=plan, kinds=DEFECTS, report=lambda _: None)
    assert list(card.thresholds) == THREE[1:]
    assert card.training_kinds == (24,) * len(THREE), card.training_kinds
    assert read_card(folder / "run" / "run.json") == card
    assert f"(K, {len(THREE)}): {', '.join(THREE)}" in (folder / "run" / "CARD.md").read_text()
    file = folder / "run" / "weldgate.onnx"
    classifier = Classifier(file)
    assert [limit.kind.name for limit in classifier.card.thresholds.kinds] == THREE[1:]
    made = crops(len(THREE))
    assert classifier(made.images).maps.shape[1] == len(CHANNELS)
    assert class_scores(classifier, made.images).shape == (len(THREE), len(THREE))
    read_network(file)
    confusion = summary(evaluate_crops(made, classifier, classifier.card.thresholds))["segments"]["confusion"]
    assert list(confusion) == THREE
    assert [sum(row.values()) for row in confusion.values()] == [1] * len(THREE)
    held_out = read_rendered([data])[1]
    found = evaluate_boxes([data], held_out, Truthful(held_out), DEFECTS)  # type: ignore[arg-type]
    assert list(found.by_kind) == list(CHANNELS)
    assert min(found.by_kind.values()) > 0.9, found
    assert (found.as_decision.fn, found.as_decision.fp) == (0, 0), found
    assert main(["export", str(file), str(data), "--out", str(folder / "small.onnx")]) in (0, 2)
    assert main(["evaluate", str(data), "--model", str(file), "--boxes"]) == 0
    one = train([data], out=folder / "one", version="1", plan=plan, kinds=[THREE.index("dent")], report=print)
    assert [n > 0 for n in one.training_kinds] == [name in ("ok", "dent") for name in THREE]


def check_old_data(folder: Path) -> None:
    """Read a dataset and a classifier that know two kinds."""
    data = dataset(folder / "two", 72, kinds=TWO)
    held_out = read_rendered([data], ())[1]
    found = evaluate_boxes([data], held_out, Truthful(held_out), DEFECTS)  # type: ignore[arg-type]
    assert list(found.by_kind) == [name for name in CHANNELS if name in TWO], found
    assert min(found.by_kind.values()) > 0.9, found
    refused(lambda: read_rendered([data]), "images/train shows no dent. Render more crops")
    assert main(["evaluate", str(data), "--model", str(MODEL), "--boxes"]) == 0
    both = [dataset(folder / "new", 36 * len(THREE)), data]
    held_out = read_rendered(both)[1]
    found = evaluate_boxes(both, held_out, Truthful(held_out), DEFECTS)  # type: ignore[arg-type]
    assert list(found.by_kind) == list(CHANNELS)
    assert min(found.by_kind.values()) > 0.9, found
    old = Classifier(MODEL)
    scores = class_scores(old, crops(8).images)
    assert (scores[:, CLASSES.index("dent")] == 0).all()
    assert CLASSES.index("dent") not in decided(scores, old.card.thresholds)
    known = ", ".join(limit.kind.name for limit in old.card.thresholds.kinds)
    refused(lambda: read_network(MODEL), f"knows {known}, today's kinds are")


def check_shipped_frames(folder: Path) -> None:
    """Evaluate the shipped frames with the shipped classifier, which knows two kinds."""
    folder.mkdir()
    (folder / "frames").symlink_to(FRAMES)
    (folder / "labels.json").symlink_to(FRAMES / "labels.json")
    inspector = Inspector(
        load_networks(NETWORKS),
        weld=WeldSettings(),
        quality=QualitySettings(),
        model=ModelSettings(),
    )
    figures = summary(evaluate_lot(folder, inspector))
    assert figures["parts"]["right"] == len(labels())
    confusion = figures["segments"]["confusion"]
    assert sum(confusion["dent"].values()) == sum(row["dent"] for row in confusion.values()) == 0
    assert sum(sum(row.values()) for name, row in confusion.items() if name != "ok") > 20
    for name in ("hole", "missing_weld"):
        assert confusion[name][name] > 0


if __name__ == "__main__":
    check_old_data(Path(sys.argv[3]))
    check_shipped_frames(Path(sys.argv[3]) / "frames")
    check_new_data(Path(sys.argv[3]))

import json
from pathlib import Path

import numpy as np
import pytest

from models.augment import augment
from models.data import HOLE, IGNORED, MISSING, OK, Defect, crop_label, read_lot, split_by_part
from models.errors import LearningError
from station.domain import SEGMENT_DEG
from tests.parts import FRAMES


@pytest.mark.parametrize(
    ("defects", "wanted"),
    [
        ((), OK),
        ((Defect(HOLE, 2, 3),), HOLE),
        ((Defect(HOLE, 362, 363),), HOLE),
        ((Defect(HOLE, 16.9, 18.4),), IGNORED),
        ((Defect(HOLE, 2, 3), Defect(MISSING, 5, 40)), MISSING),
        ((Defect(MISSING, 15, 40), Defect(HOLE, 2, 3)), HOLE),
        ((Defect(MISSING, 0, 360),), MISSING),
        ((Defect(MISSING, 300, 365),), MISSING),
        ((Defect(HOLE, 40, 41),), OK),
    ],
)
def test_labels_of_the_first_crop(defects: tuple[Defect, ...], wanted: int) -> None:
    assert crop_label(defects, 0.0, SEGMENT_DEG) == wanted


def lot(folder: Path, **changes: object) -> Path:
    labels = json.loads((FRAMES / "labels.json").read_text())
    item = {**labels["frames"][0], **changes}
    (folder / "frames").mkdir()
    (folder / "labels.json").write_text(json.dumps({"frames": [item]}))
    return folder


def test_strips_of_one_part_stay_on_one_side(tmp_path: Path, rng: np.random.Generator) -> None:
    folder = lot(tmp_path)
    labels = json.loads((folder / "labels.json").read_text())
    name = labels["frames"][0]["frame"]
    (folder / "frames" / name).symlink_to(FRAMES / name)
    (folder / "frames" / "b.png").symlink_to(FRAMES / name)
    labels["frames"].append({**labels["frames"][0], "frame": "b.png"})
    (folder / "labels.json").write_text(json.dumps(labels))
    training, held = split_by_part(read_lot(folder, 2, rng), 0.5)
    assert len(training) == len(held) == 3
    assert not {s.part for s in training} & {s.part for s in held}
    assert (training[0].strip != training[1].strip).any()


@pytest.mark.parametrize(
    ("changes", "said"), [({"frame": "absent.png"}, "1 images are missing"), ({"frame": "bad.png"}, "not a readable image")]
)
def test_wrong_lots_are_refused(changes: dict[str, object], said: str, tmp_path: Path, rng: np.random.Generator) -> None:
    folder = lot(tmp_path, **changes)
    (folder / "frames" / "bad.png").write_bytes(b"x")
    with pytest.raises(LearningError, match=said):
        read_lot(folder, 0, rng)


def test_no_lot_says_how_to_make_one(tmp_path: Path, rng: np.random.Generator) -> None:
    with pytest.raises(LearningError, match="weldgate-synth part"):
        read_lot(tmp_path, 0, rng)


def test_augment_keeps_form_and_is_drawn_from_the_generator() -> None:
    crop = np.random.default_rng(1).integers(0, 256, (128, 128), dtype=np.uint8)
    first, second = augment(crop, np.random.default_rng(2)), augment(crop, np.random.default_rng(2))
    assert first.shape == crop.shape
    assert first.dtype == np.uint8
    assert (first == second).all()
    assert (first != augment(crop, np.random.default_rng(3))).any()

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from models.data.crops import DEFECTS, IGNORED, OK
from models.data.labelled import (
    LabelledStrip,
    label_of_arc,
    read_lot,
    split_by_part,
    station_crops,
    window_crops,
)
from models.data.lot import Defect, read_labels
from models.errors import LearningError
from station.classify.onnx import CLASSES
from station.domain import SEGMENT_DEG, STRIP_COLUMNS
from station.files.image import encode_png, read_image
from tests.models.made import HOLE, MISSING
from tests.parts import FRAMES


@pytest.mark.parametrize(
    ("defects", "label"),
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
def test_labels_of_the_first_crop(defects: tuple[Defect, ...], label: int) -> None:
    assert label_of_arc(defects, 0.0, SEGMENT_DEG) == label


def strips(count: int) -> list[LabelledStrip]:
    """Strips with nothing, a hole, a missing weld or another kind of defect, in turn."""
    rng = np.random.default_rng(0)
    arcs = dict.fromkeys(DEFECTS, (100.0, 110.0)) | {HOLE: (40.0, 44.0), MISSING: (350.0, 380.0)}
    kinds = ((), *((Defect(label, *arc),) for label, arc in arcs.items()))
    images = [rng.integers(0, 256, (128, STRIP_COLUMNS), dtype=np.uint8) for _ in range(count)]
    return [LabelledStrip(f"p{i}", image, kinds[i % len(kinds)]) for i, image in enumerate(images)]


ALL = 1 + len(DEFECTS)
"""Number of strips that show each kind once, or nothing."""


def test_the_window_slides_by_ten_pixels_and_round_the_seam() -> None:
    found = window_crops(strips(ALL), 10, None)
    assert len(found) > ALL * 260 - 60
    holes = found.pick(found.labels == HOLE)
    assert set(holes.parts) == {f"p{HOLE}"}
    assert 10 <= len(holes) <= 17  # 128 px of crop and a hole of 30 px, at least a fifth of it inside
    assert not found.mapped.any()


def test_balancing_repeats_the_rarer_defect_and_cuts_the_good_ones() -> None:
    found = window_crops(strips(ALL), 10, np.random.default_rng(1))
    of_defects = {found.count(label) for label in DEFECTS}
    assert of_defects == {found.count(OK) // len(DEFECTS)}


def test_kinds_that_are_lacking_are_named() -> None:
    with pytest.raises(LearningError, match=f"show no .*{CLASSES[DEFECTS[-1]]}"):
        window_crops(strips(ALL - 1), 10, np.random.default_rng(1))


def test_the_stations_crops_leave_open_ones_out() -> None:
    found = station_crops(strips(ALL))
    assert len(found) <= 21 * ALL
    assert found.count(HOLE) == 1
    assert found.count(MISSING) >= 2


@pytest.mark.parametrize("seed", range(4))
def test_a_split_by_part_shares_no_part_and_gives_each_side_its_defects(seed: int) -> None:
    sides = split_by_part(strips(60), seed)
    names = [{s.part for s in side} for side in sides]
    assert [len(n) for n in names] == [42, 9, 9]
    assert not names[0] & names[1] | names[0] & names[2] | names[1] & names[2]
    assert all(3 <= sum(bool(s.defects) for s in side) for side in sides)


def test_too_few_parts_are_refused() -> None:
    with pytest.raises(LearningError, match="too few"):
        split_by_part(strips(2), 0)


def lot(folder: Path, **changes: object) -> Path:
    """A lot of one entry, changed."""
    item = {**json.loads((FRAMES / "labels.json").read_text())["frames"][0], **changes}
    (folder / "frames").mkdir(parents=True)
    (folder / "frames" / "bad.png").write_bytes(b"x")
    for image in FRAMES.glob("*.png"):
        (folder / "frames" / image.name).symlink_to(image)
    (folder / "labels.json").write_text(json.dumps({"frames": [item]}))
    return folder


def test_a_lot_is_cut_at_its_labelled_rings(tmp_path: Path) -> None:
    (strip,) = read_lot(lot(tmp_path))
    assert strip.strip.shape == (128, STRIP_COLUMNS)
    assert (strip.crop(STRIP_COLUMNS - 64)[:, 64:] == strip.strip[:, :64]).all()


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"frame": "absent.png"}, "absent.png: the image is missing"),
        ({"frame": "bad.png"}, "not a readable image"),
        ({"radius": -1}, "centre and radius"),
        ({"um_per_px": 5}, "um_per_px 5 must be 9 to 65"),
        ({"center": [5.0, 5.0]}, "not wholly in view"),
        ({"verdict": "NOK", "defects": [{"kind": "dent", "angle_deg": [1, 2]}]}, "unknown kind dent"),
        ({"verdict": "NOK", "defects": [{"kind": "hole", "angle_deg": [9, 2]}]}, "angle_deg"),
        ({"verdict": "NOK", "defects": []}, "does not fit 0 defects"),
        ({"defects": None}, "lacks or garbles"),
    ],
)
def test_wrong_lots_are_refused(changes: dict[str, object], problem: str, tmp_path: Path) -> None:
    with pytest.raises(LearningError, match=problem):
        read_lot(lot(tmp_path, **changes))


def test_a_part_labelled_twice_is_refused(tmp_path: Path) -> None:
    folder = lot(tmp_path)
    content = json.loads((folder / "labels.json").read_text())
    (folder / "labels.json").write_text(json.dumps({"frames": content["frames"] * 2}))
    with pytest.raises(LearningError, match="labelled twice"):
        read_labels(folder)


def test_no_lot_says_how_to_make_one(tmp_path: Path) -> None:
    with pytest.raises(LearningError, match="weldgate-synth part"):
        read_lot(tmp_path)


def test_a_lot_of_another_scale_gives_the_same_strips(tmp_path: Path) -> None:
    entry = json.loads((FRAMES / "labels.json").read_text())["frames"][0]
    (ours,) = read_lot(lot(tmp_path / "ours"))
    center = [(v + 0.5) / 2 - 0.5 for v in entry["center"]]
    coarse = lot(tmp_path / "coarse", center=center, radius=entry["radius"] / 2, um_per_px=26)
    path = coarse / "frames" / entry["frame"]
    half = cv2.resize(read_image(path), None, fx=0.5, fy=0.5, interpolation=cv2.INTER_AREA)
    path.unlink()
    path.write_bytes(encode_png(np.asarray(half, np.uint8)))
    (strip,) = read_lot(coarse)
    smooth = cv2.GaussianBlur(ours.strip, (0, 0), 1.0)
    assert np.abs(strip.strip.astype(float) - smooth).mean() < 0.2 * ours.strip.std()

"""What is not seen is never OK: pictures of nothing, covered defects, and welds upside down in brightness."""

import numpy as np
import pytest
from numpy.typing import NDArray

from deploy.chaos.covered import judged_under_covers
from deploy.chaos.covers import COVERS
from models.data.lot import LabelledFrame
from station.domain import Image, Verdict
from station.inspection.inspector import Inspector
from station.inspection.networks import load_networks
from station.settings.model import ModelSettings, QualitySettings, WeldSettings
from tests.conftest import NETWORKS
from tests.parts import label_with

SIZE = (1200, 1400)


@pytest.fixture(scope="module")
def inspector() -> Inspector:
    """The shipped networks with default limits."""
    return Inspector(
        load_networks(NETWORKS), weld=WeldSettings(), quality=QualitySettings(), model=ModelSettings()
    )


def _rows_and_columns() -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    rows, columns = np.indices(SIZE, np.float64)
    return rows, columns


def _nothing(name: str) -> Image:
    """Return a picture (1200, 1400) uint8 that shows no weld."""
    rows, columns = _rows_and_columns()
    rng = np.random.default_rng(5)
    away = np.hypot(columns - 700, rows - 600)
    made = {
        "noise": lambda: rng.uniform(0, 255, SIZE),
        "grain": lambda: rng.normal(110, 12, SIZE),
        "stripes": lambda: 120 + 80 * np.sign(np.sin(columns / 9)),
        "fine stripes": lambda: 120 + 60 * np.sin(rows / 2),
        "chequers": lambda: 120 + 90 * np.sign(np.sin(columns / 20) * np.sin(rows / 20)),
        "gradient": lambda: columns / SIZE[1] * 255,
        "hill": lambda: 255 - away / 3,
        "rings": lambda: 120 + 100 * np.sin(away / 12),
        "bore": lambda: np.where(away < 428, 15.0, 150.0) + rng.normal(0, 4, SIZE),
        "clamp ring": lambda: np.where(np.abs(away - 428) < 40, 190.0, 110.0) + rng.normal(0, 4, SIZE),
    }
    return np.asarray(np.clip(made[name](), 0, 255), np.uint8)


@pytest.mark.parametrize("level", [0, 1, 30, 90, 128, 200, 254, 255])
def test_one_grey_level_is_never_ok(inspector: Inspector, level: int) -> None:
    assert inspector.inspect(np.full(SIZE, level, np.uint8)).verdict is Verdict.ERROR


@pytest.mark.parametrize(
    "name",
    [
        "noise",
        "grain",
        "stripes",
        "fine stripes",
        "chequers",
        "gradient",
        "hill",
        "rings",
        "bore",
        "clamp ring",
    ],
)
def test_a_picture_of_something_else_is_never_ok(inspector: Inspector, name: str) -> None:
    judged = inspector.inspect(_nothing(name))

    assert judged.verdict is not Verdict.OK
    assert judged.detail or judged.verdict is Verdict.NOK


@pytest.mark.parametrize("kind", ["hole", "missing_weld"])
def test_a_covered_defect_is_never_ok(inspector: Inspector, frames: dict[str, Image], kind: str) -> None:
    label = label_with(kind)
    found = dict(judged_under_covers(inspector, _labelled(label), frames[label["frame"]], seed=1))

    assert set(found) == set(COVERS)
    assert Verdict.OK not in found.values(), found


def test_what_lies_beside_a_good_weld_does_not_matter(inspector: Inspector, frames: dict[str, Image]) -> None:
    label = label_with("OK")
    found = dict(judged_under_covers(inspector, _labelled(label), frames[label["frame"]], seed=1))

    assert len(found) == len(COVERS) - 1
    assert set(found.values()) == {Verdict.OK}, found


def _labelled(label: dict) -> LabelledFrame:  # type: ignore[type-arg] # any JSON
    x, y = label["center"]
    return LabelledFrame(
        name=label["frame"],
        center_x_px=x,
        center_y_px=y,
        radius_px=label["radius"],
        verdict=label["verdict"],
        defects=(),
    )

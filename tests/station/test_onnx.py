import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import onnx
import pytest

from station.classify.onnx import METADATA_KEYS, Classifier
from station.errors import ModelError
from tests.conftest import MODEL


def test_the_shipped_model_says_what_it_is(classifier: Classifier) -> None:
    assert classifier.card.version
    assert len(classifier.card.data_hash) == 64
    assert [limit.kind.name for limit in classifier.card.thresholds.kinds] == ["hole", "missing_weld"]


def test_one_crop_and_many_give_the_same(classifier: Classifier, rng: np.random.Generator) -> None:
    crops = rng.integers(0, 256, (21, 128, 128), dtype=np.uint8)
    many, one = classifier(crops), classifier(crops[4:5])
    assert many.scores[4].nok == pytest.approx(one.scores[0].nok, abs=1e-5)
    assert many.maps[4] == pytest.approx(one.maps[0], abs=1e-4)
    assert many.appearances[4] == pytest.approx(one.appearances[0], rel=1e-3, abs=1e-3)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match=r"none\.onnx"):
        Classifier(tmp_path / "none.onnx")


@pytest.mark.parametrize("keep", [0, 10, 5000])
def test_a_damaged_file_is_refused(keep: int, tmp_path: Path) -> None:
    path = tmp_path / "bad.onnx"
    path.write_bytes(MODEL.read_bytes()[:keep])
    with pytest.raises(ModelError, match=r"bad\.onnx"):
        Classifier(path)


@pytest.mark.parametrize("key", METADATA_KEYS)
def test_a_model_without_its_metadata_is_refused(key: str, tmp_path: Path) -> None:
    model = onnx.load(str(MODEL))
    kept = [m for m in model.metadata_props if m.key != key]
    del model.metadata_props[:]
    model.metadata_props.extend(kept)
    onnx.save(model, str(tmp_path / "bare.onnx"))
    with pytest.raises(ModelError, match=key):
        Classifier(tmp_path / "bare.onnx")


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("weldgate.classes", '["a", "b"]', "classes"),
        ("weldgate.thresholds", "[]", "cannot be read"),
        ("weldgate.thresholds", "{}", "between 0 and 1, one for each"),
        ("weldgate.classes", '["ok", "hole", "dent"]', "unknown kind of defect 'dent'"),
        ("weldgate.thresholds", '{"hole": 2, "missing_weld": 0.5}', "between 0 and 1"),
        *(("weldgate.novelty_limit", limit, "above 0") for limit in ("-1", "0", "NaN", "Infinity")),
        ("weldgate.novelty_limit", "null", "cannot be read"),
    ],
)
def test_foreign_metadata_is_refused(key: str, value: str, message: str, tmp_path: Path) -> None:
    model = onnx.load(str(MODEL))
    next(m for m in model.metadata_props if m.key == key).value = value
    onnx.save(model, str(tmp_path / "odd.onnx"))
    with pytest.raises(ModelError, match=message):
        Classifier(tmp_path / "odd.onnx")


def test_loading_a_network_leaves_no_identifier_of_the_machine(tmp_path: Path) -> None:
    load = f"Classifier(Path({str(MODEL)!r}))"
    code = f"from pathlib import Path; from station.classify.onnx import Classifier; {load}"
    environment = {name: value for name, value in os.environ.items() if not name.startswith(("ORT_", "XDG_"))}
    subprocess.run([sys.executable, "-c", code], env=environment | {"HOME": str(tmp_path)}, check=True)
    assert not [path for path in tmp_path.rglob("*") if path.is_file()]

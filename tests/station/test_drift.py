from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.classify.drift import Drift, DriftWatch, Reference, read_reference, write_reference
from station.errors import ModelError

REFERENCE = Reference(model_hash="abc", parts=20, mean=(1.0, -2.0), spread=(0.5, 2.0), limit=0.7)


def test_pictures_like_the_reference_do_not_drift() -> None:
    watch = DriftWatch(REFERENCE)
    assert watch.part(np.array([1.0, -2.0])) == Drift(0.0, 0.7)


@given(st.floats(-5, 5), st.integers(1, 60))
def test_a_constant_shift_is_approached_and_never_passed(shift: float, parts: int) -> None:
    watch = DriftWatch(REFERENCE)
    values = [watch.part(np.array([1.0 + 0.5 * shift, -2.0 + 2.0 * shift])).value for _ in range(parts)]
    assert values == sorted(values)
    assert values[-1] == pytest.approx((1 - 0.9**parts) ** 2 * shift**2, abs=1e-9)


def test_shifts_of_both_signs_are_told_and_forgotten() -> None:
    for sign in (-1, 1):
        watch = DriftWatch(REFERENCE)
        drifted = [watch.part(np.array([1.0 + sign, -2.0])) for _ in range(60)]
        assert not drifted[0].alarm
        assert drifted[-1].alarm
        assert not [watch.part(np.array([1.0, -2.0])) for _ in range(60)][-1].alarm


def test_a_reference_comes_back_from_its_file(tmp_path: Path) -> None:
    write_reference(tmp_path / "line.json", REFERENCE)
    assert read_reference(tmp_path / "line.json", "abc", 2) == REFERENCE


@pytest.mark.parametrize(
    ("text", "model", "size", "message"),
    [
        (None, "abc", 2, "cannot be read"),
        ("{", "abc", 2, "not a reference"),
        ('{"model_hash": 1}', "abc", 2, "not a reference"),
        ("good", "other", 2, "a different classifier"),
        ("good", "abc", 3, "damaged"),
        (
            '{"model_hash": "abc", "parts": 20, "mean": [1, 2], "spread": [1, 0], "limit": 1}',
            "abc",
            2,
            "damaged",
        ),
    ],
)
def test_a_reference_that_does_not_fit_is_refused(
    text: str | None, model: str, size: int, message: str, tmp_path: Path
) -> None:
    path = tmp_path / "line.json"
    if text == "good":
        write_reference(path, REFERENCE)
    elif text is not None:
        path.write_text(text)
    with pytest.raises(ModelError, match=message) as error:
        read_reference(path, model, size)
    assert "first-day --reference" in str(error.value)

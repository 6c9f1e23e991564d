import numpy as np
import pytest

from models.classifier.reference import MIN_PARTS, make_reference
from models.errors import LearningError
from station.classify.drift import DriftWatch

SIZE = 192


def looks(parts: int, seed: int) -> np.ndarray:  # type: ignore[type-arg]
    """Looks of parts of one line: components of different spread, neighbours alike, as a network's are."""
    rng = np.random.default_rng(seed)
    mixing = np.random.default_rng(0).normal(0, 0.05, (SIZE, SIZE)) + np.eye(SIZE)
    return rng.normal(0, np.linspace(0.1, 0.6, SIZE), (parts, SIZE)) @ mixing + 0.3


@pytest.mark.parametrize("parts", [MIN_PARTS, 40, 150])
def test_the_limit_holds_for_further_good_parts_and_reports_a_shift_of_one_spread(parts: int) -> None:
    alarms = 0
    for seed in range(10):
        reference = make_reference(looks(parts, seed), "abc")
        watch = DriftWatch(reference)
        alarms += any(watch.part(look).alarm for look in looks(100, 1000 + seed))
        shifted = DriftWatch(reference)
        assert [shifted.part(look + reference.spread).alarm for look in looks(30, 2000 + seed)][-1]
    assert alarms <= 1


def test_too_few_parts_and_one_part_copied_are_refused() -> None:
    with pytest.raises(LearningError, match="19 good parts were judged; a reference needs at least 20"):
        make_reference(looks(19, 0), "abc")
    with pytest.raises(LearningError, match="images of all parts are the same"):
        make_reference(np.repeat(looks(1, 0), 30, axis=0), "abc")

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.classifier.novelty import describe, distances, limit, part_distances
from models.data.crops import OK
from models.evaluation.measures import Counts, calibration_error, choose_thresholds, count, refused
from station.analysis.truth import interval
from station.classify.decision import segment_kind
from tests.models.made import HOLE, MISSING
from tests.parts import scores_of, thresholds


def test_the_papers_equations() -> None:
    found = Counts(tp=90, fp=10, fn=5, tn=100)
    assert (found.precision, found.recall) == (0.9, 90 / 95)
    assert found.f2 == pytest.approx(5 * 0.9 * (90 / 95) / (4 * 0.9 + 90 / 95))


def test_intervals_hold_the_share_and_narrow_with_trials() -> None:
    assert interval(0, 0) == (0.0, 1.0)
    assert interval(0, 30)[1] == pytest.approx(0.1157, abs=1e-3)  # the "rule of three" in its exact form
    wide, narrow = interval(5, 50), interval(50, 500)
    assert wide[0] < narrow[0] < 0.1 < narrow[1] < wide[1]


SCORE = st.tuples(st.floats(0, 1), st.floats(0, 1), st.floats(0, 1))


@given(st.lists(SCORE, min_size=1, max_size=20), st.floats(0.05, 0.9), st.floats(0.05, 0.9))
def test_the_decision_is_the_stations(raw: list[tuple[float, float, float]], hole: float, gone: float) -> None:
    scores = np.array(raw)
    limits = thresholds(hole, gone)
    wanted = [segment_kind(scores_of(*row), limits) is not None for row in scores.tolist()]
    assert refused(scores, limits).tolist() == wanted


def test_thresholds_part_what_can_be_parted() -> None:
    rng = np.random.default_rng(0)
    labels = rng.choice([OK, HOLE, MISSING], 600, p=[0.6, 0.2, 0.2])
    scores = np.full((600, 3), 0.05)
    for index, label in enumerate(labels):
        bad = rng.uniform(0.3, 0.45) if label else rng.uniform(0.05, 0.2)
        scores[index, HOLE if label != MISSING else MISSING] = bad
    scores[:, OK] = 1 - scores[:, 1:].sum(axis=1)
    limits = choose_thresholds(scores, labels)
    assert count(refused(scores, limits), labels != OK).f2 == 1.0
    assert 0.2 < limits.kinds[0].threshold <= 0.3
    assert limits.kinds[1].threshold <= 0.3


def test_calibration_error_of_honest_and_of_boastful_scores() -> None:
    rng = np.random.default_rng(1)
    p = rng.uniform(0, 1, 20000)
    truth = rng.random(20000) < p
    assert calibration_error(p, truth) < 0.02
    assert calibration_error(np.where(p > 0.5, 1.0, 0.0), truth) > 0.15


def test_features_from_elsewhere_are_farther_than_those_known() -> None:
    rng = np.random.default_rng(2)
    mixing = rng.normal(size=(12, 12))
    known, fresh = (rng.normal(size=(3000, 12)) @ mixing + 3 for _ in range(2))
    mean, whitening = describe(known)
    inside = distances(fresh, mean, whitening)
    assert inside.mean() == pytest.approx(1.0, abs=0.05)
    parts = np.repeat(np.arange(150).astype(str), 20)
    bound = limit(part_distances(inside, parts))
    shifted = part_distances(distances(fresh + 5.0 * mixing[0], mean, whitening), parts)
    assert (part_distances(inside, parts) <= bound).all()
    assert (shifted > bound).all()

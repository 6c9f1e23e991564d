import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.classifier.novelty import describe, distances, limit, part_distances
from models.data.crops import DEFECTS, OK
from models.evaluation.measures import (
    THRESHOLDS,
    Counts,
    FBeta,
    calibration_error,
    choose_thresholds,
    count,
    decided,
    rejected,
)
from station.analysis.truth import interval
from station.classify.decision import segment_kind
from station.classify.onnx import CLASSES
from station.classify.thresholds import Limit, Thresholds
from station.defects import KINDS
from station.domain import SegmentScores


def test_the_papers_equations() -> None:
    found = Counts(tp=90, fp=10, fn=5, tn=100)
    assert (found.precision, found.recall) == (0.9, 90 / 95)
    assert found.f2 == pytest.approx(5 * 0.9 * (90 / 95) / (4 * 0.9 + 90 / 95))


def test_intervals_hold_the_share_and_narrow_with_trials() -> None:
    assert interval(0, 0) == (0.0, 1.0)
    assert interval(0, 30)[1] == pytest.approx(0.1157, abs=1e-3)  # the "rule of three" in its exact form
    wide, narrow = interval(5, 50), interval(50, 500)
    assert wide[0] < narrow[0] < 0.1 < narrow[1] < wide[1]


VALUE = st.sampled_from([0.0, 0.2, 0.3, 0.5, 0.9]) | st.floats(0, 1)
"""Some values often, so that scores are equal to each other and to thresholds."""
SCORES = st.lists(st.lists(VALUE, min_size=len(CLASSES), max_size=len(CLASSES)), min_size=1, max_size=20)


@settings(deadline=None)  # a loaded machine takes its time
@given(SCORES, st.lists(VALUE, min_size=len(KINDS), max_size=len(KINDS)))
def test_the_decision_is_the_stations(rows: list[list[float]], values: list[float]) -> None:
    limits = Thresholds(tuple(Limit(kind, value) for kind, value in zip(KINDS, values, strict=True)))
    kinds = [
        segment_kind(SegmentScores(row[0], dict(zip(KINDS, row[1:], strict=True))), limits) for row in rows
    ]
    assert [CLASSES[label] for label in decided(np.array(rows), limits)] == [
        "ok" if k is None else k.name for k in kinds
    ]
    assert rejected(np.array(rows), limits).tolist() == [kind is not None for kind in kinds]


def test_a_file_that_knows_fewer_kinds_decides_among_those() -> None:
    limits = Thresholds((Limit(KINDS[-1], 0.4),))
    scores = np.zeros((3, len(CLASSES)))
    scores[:, [OK, -1]] = [[0.7, 0.3], [0.55, 0.45], [0.4, 0.6]]
    assert decided(scores, limits).tolist() == [OK, len(KINDS), len(KINDS)]


@settings(deadline=None)  # a loaded machine takes its time
@given(SCORES, st.lists(st.integers(0, THRESHOLDS.size - 1), min_size=len(KINDS), max_size=len(KINDS)))
def test_the_search_for_thresholds_rejects_as_the_station(rows: list[list[float]], places: list[int]) -> None:
    scores = np.array(rows)
    limits = Thresholds(
        tuple(Limit(kind, float(THRESHOLDS[i])) for kind, i in zip(KINDS, places, strict=True))
    )
    search = FBeta(scores, np.zeros(len(rows), np.int64), 2.0)
    assert search.rejected(places).tolist() == rejected(scores, limits).tolist()


def test_thresholds_part_what_can_be_parted() -> None:
    rng = np.random.default_rng(0)
    labels = rng.choice([OK, *DEFECTS], 600)
    scores = np.full((600, len(CLASSES)), 0.02)
    for index, label in enumerate(labels):
        scores[index, label or DEFECTS[0]] = rng.uniform(0.3, 0.45) if label else rng.uniform(0.05, 0.2)
    scores[:, OK] = 1 - scores[:, 1:].sum(axis=1)
    limits = choose_thresholds(scores, labels)
    assert count(rejected(scores, limits), labels != OK).f2 == 1.0
    assert 0.2 < limits.kinds[0].threshold <= 0.3
    assert all(limit.threshold <= 0.3 for limit in limits.kinds)


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

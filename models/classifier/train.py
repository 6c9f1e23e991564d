"""One training run: crops in, a released ONNX file, its card and its figures out."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from models.classifier.card import write_card
from models.classifier.export import Contract, export, read_network
from models.classifier.fit import Plan, Report, fit, predict
from models.classifier.network import WeldNet
from models.classifier.novelty import describe, distances, limit, part_distances
from models.data.crops import DEFECTS, OK, Crops, only
from models.data.labelled import (
    WINDOW_STEP_PX,
    data_hash,
    read_lot,
    split_by_part,
    station_crops,
    window_crops,
)
from models.data.rendered import read_rendered
from models.errors import LearningError
from models.evaluation.measures import (
    ESCAPE_COST,
    calibration_error,
    choose_thresholds,
    count,
    line_weights,
    prior_shift,
    rejected,
    shifted,
)
from models.evaluation.scores import class_scores
from station.classify.onnx import Classifier
from station.classify.thresholds import Thresholds

RENDERED = "The network has seen rendered images only."
FINE_TUNED = "Fine-tuned on a line's own labelled images, those of other parts held out."
FINE_TUNING = Plan(steps=600, learning_rate=0.0005, hardness=0.0, unseen_loss=None)


def train(
    folders: Sequence[Path], out: Path, version: str, plan: Plan, kinds: Sequence[int], report: Report
) -> dict[str, Any]:
    """Train on rendered datasets; with one of `kinds` alone, OK crops against those with that defect.

    Writes weldgate.onnx, run.json and CARD.md into `out` and returns the card. Raises LearningError.
    """
    training, held, digest = read_rendered(folders)
    if set(kinds) != set(DEFECTS):
        training, held = only(training, kinds), only(held, kinds)
        share, left = plan.shares[OK], sum(plan.shares[kind] for kind in kinds)
        own = (plan.shares[kind] if kind in kinds else 0.0 for kind in DEFECTS)
        plan = replace(plan, shares=(share, *((1 - share) * one / left for one in own)))
    torch.manual_seed(plan.seed)
    start = perf_counter()
    network = fit(WeldNet(), training, plan, report)
    return release(network, training, held, out, version, digest, plan, perf_counter() - start, RENDERED)


def fine_tune(
    lot: Path, model: Path | None, out: Path, version: str, seed: int, report: Report
) -> dict[str, Any]:
    """The paper's protocol for a line's own labelled images (section 3.2): window of 10 px, balanced, 70/15/15 % by part.

    With `model` its network is trained further, without one a new network. The thresholds are chosen on the validation parts; the
    card's figures are those of the test parts, crops as the station cuts them. Raises LearningError, ModelError.
    """
    train_strips, validation_strips, test_strips = split_by_part(read_lot(lot), seed)
    training = window_crops(train_strips, WINDOW_STEP_PX, np.random.default_rng(seed))
    plan = (
        replace(FINE_TUNING, seed=seed)
        if model is not None
        else Plan(steps=2000, unseen_loss=None, seed=seed)
    )
    torch.manual_seed(seed)
    start = perf_counter()
    network = fit(WeldNet() if model is None else read_network(model), training, plan, report)
    seconds = perf_counter() - start
    validation = window_crops(validation_strips, WINDOW_STEP_PX, None)
    judged = station_crops(test_strips)
    return release(
        network, training, validation, out, version, data_hash([lot]), plan, seconds, FINE_TUNED, judged
    )


def release(
    network: WeldNet,
    training: Crops,
    held: Crops,
    out: Path,
    version: str,
    digest: str,
    plan: Plan,
    seconds: float,
    provenance: str,
    judged: Crops | None = None,
) -> dict[str, Any]:
    """Choose thresholds on `held`, describe the training images, write and check the file; figures on `judged`, by default `held`."""
    shift = prior_shift(plan.shares)
    raw, held_statistics = predict(network, held.images)
    scores = shifted(raw, shift)
    thresholds = choose_thresholds(scores, held.labels)
    mean, whitening = describe(predict(network, training.images)[1])
    novelty_limit = limit(part_distances(distances(held_statistics, mean, whitening), held.parts))
    out.mkdir(parents=True, exist_ok=True)
    export(
        network,
        out / "weldgate.onnx",
        Contract(version, digest, thresholds, mean, whitening, novelty_limit, shift),
    )
    crops = held if judged is None else judged
    card: dict[str, Any] = {
        "version": version,
        "provenance": provenance,
        "data_hash": digest,
        "training_crops": len(training),
        "training_kinds": [training.count(kind) for kind in (OK, *DEFECTS)],
        "held_out_crops": len(crops),
        "weights": sum(p.numel() for p in network.parameters()),
        "thresholds": {limit.kind.name: limit.threshold for limit in thresholds.kinds},
        "held_out": figures(
            class_scores(Classifier(out / "weldgate.onnx"), crops.images), crops.labels, thresholds
        ),
        "novelty_limit": novelty_limit,
        "seconds": seconds,
        "plan": asdict(plan),
    }
    write_card(out, card)
    return card


def figures(
    scores: NDArray[np.float64], labels: NDArray[np.int64], thresholds: Thresholds
) -> dict[str, float]:
    """What a card says of scores (N, classes) against labels (N,)."""
    if not len(labels):
        raise LearningError("no crops to judge")
    found = count(rejected(scores, thresholds), labels != OK)
    return {
        **asdict(found),
        "precision": found.precision,
        "recall": found.recall,
        "f2": found.f2,
        "calibration_error": calibration_error(
            1 - scores[:, OK], labels != OK, line_weights(labels, ESCAPE_COST)
        ),
    }

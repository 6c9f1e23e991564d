"""One training run of the classifier: crops in; a released ONNX file, its card and its figures out."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from time import perf_counter

import numpy as np
import torch
from numpy.typing import NDArray

from models.classifier.card import HeldOut, RunCard, write_card
from models.classifier.export import Contract, export, read_network
from models.classifier.fit import Report, fit, predict
from models.classifier.network import WeldNet
from models.classifier.novelty import describe, distances, limit, part_distances
from models.classifier.plan import Plan
from models.data.crops import DEFECTS, OK, Crops, only
from models.data.labelled import WINDOW_STEP_PX, read_lot, split_by_part, station_crops, window_crops
from models.data.lot import data_hash
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
FINE_TUNED = "Fine-tuned on a line's own labelled images, tested on those of other parts."
FINE_TUNING = Plan(steps=600, learning_rate=0.0005, hardness=0.0, unseen_loss=None)


def train(
    folders: Sequence[Path], *, out: Path, version: str, plan: Plan, kinds: Sequence[int], report: Report
) -> RunCard:
    """Train on rendered datasets: OK crops against those of `kinds` (labels).

    Writes weldgate.onnx, run.json and CARD.md into `out` and returns the card. Raises LearningError.
    """
    training, held_out, digest = read_rendered(folders, kinds)
    if set(kinds) != set(DEFECTS):
        training, held_out, plan = only(training, kinds), only(held_out, kinds), plan.limited_to(kinds)
    torch.manual_seed(plan.seed)
    start = perf_counter()
    network = fit(WeldNet(), training, plan, report)
    return release(
        network,
        training=training,
        held_out=held_out,
        judged=held_out,
        out=out,
        version=version,
        digest=digest,
        plan=plan,
        seconds=perf_counter() - start,
        provenance=RENDERED,
    )


def fine_tune(
    lot: Path, *, model: Path | None, out: Path, version: str, seed: int, report: Report
) -> RunCard:
    """Train on a line's own labelled images by the paper's protocol (section 3.2).

    This is a window of 10 px, kinds balanced, 70/15/15 % of the parts. With `model` its network is trained
    further, without one a new network. The thresholds are chosen on the validation parts; the card's figures
    are those of the test parts, cut as the station cuts them. Raises LearningError, ModelError.
    """
    train_strips, validation_strips, test_strips = split_by_part(read_lot(lot), seed)
    training = window_crops(train_strips, WINDOW_STEP_PX, np.random.default_rng(seed))
    from_nothing = Plan(steps=2000, unseen_loss=None, seed=seed)
    plan = from_nothing if model is None else replace(FINE_TUNING, seed=seed)
    torch.manual_seed(seed)
    start = perf_counter()
    network = fit(WeldNet() if model is None else read_network(model), training, plan, report)
    return release(
        network,
        training=training,
        held_out=window_crops(validation_strips, WINDOW_STEP_PX, None),
        judged=station_crops(test_strips),
        out=out,
        version=version,
        digest=data_hash([lot]),
        plan=plan,
        seconds=perf_counter() - start,
        provenance=FINE_TUNED,
    )


def release(
    network: WeldNet,
    *,
    training: Crops,
    held_out: Crops,
    judged: Crops,
    out: Path,
    version: str,
    digest: str,
    plan: Plan,
    seconds: float,
    provenance: str,
) -> RunCard:
    """Write and check the file and its card: thresholds chosen on `held_out`, figures on `judged`."""
    shift = prior_shift(plan.shares)
    raw, held_out_features = predict(network, held_out.images)
    thresholds = choose_thresholds(shifted(raw, shift), held_out.labels)
    mean, whitening = describe(predict(network, training.images)[1])
    contract = Contract(
        version=version,
        data_hash=digest,
        thresholds=thresholds,
        mean=mean,
        whitening=whitening,
        novelty_limit=limit(part_distances(distances(held_out_features, mean, whitening), held_out.parts)),
        prior_shift=shift,
    )
    out.mkdir(parents=True, exist_ok=True)
    export(network, out / "weldgate.onnx", contract)
    scores = class_scores(Classifier(out / "weldgate.onnx"), judged.images)
    card = RunCard(
        version=version,
        provenance=provenance,
        data_hash=digest,
        training_crops=len(training),
        training_kinds=tuple(training.count(label) for label in (OK, *DEFECTS)),
        held_out_crops=len(judged),
        weights=sum(p.numel() for p in network.parameters()),
        thresholds={limit.kind.name: limit.threshold for limit in thresholds.kinds},
        held_out=figures(scores, judged.labels, thresholds),
        novelty_limit=contract.novelty_limit,
        seconds=seconds,
        plan=plan,
    )
    write_card(out, card)
    return card


def figures(scores: NDArray[np.float64], labels: NDArray[np.int64], thresholds: Thresholds) -> HeldOut:
    """Return a card's figures from scores (N, classes) and labels (N,).

    Raises LearningError without crops.
    """
    if not len(labels):
        raise LearningError("no crops are left to judge. Label more parts")
    truth = labels != OK
    found = count(rejected(scores, thresholds), truth)
    return HeldOut(
        **asdict(found),
        precision=found.precision,
        recall=found.recall,
        f2=found.f2,
        calibration_error=calibration_error(1 - scores[:, OK], truth, line_weights(labels, ESCAPE_COST)),
    )

"""Command line of the learning room, `weldgate-models`."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

from models.arguments import KINDS, SHIPPED, check_numbers, make_parser
from models.errors import LearningError
from station.errors import WeldgateError
from station.files.destination import standard_output_free

if TYPE_CHECKING:
    from models.data.crops import Crops
    from models.evaluation.evaluate import Evaluation
    from station.inspection.inspector import Inspector


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; return 0 if all is well, 1 if something is wrong, 2 if it could not be done."""
    arguments = make_parser(COMMANDS).parse_args(argv)
    try:
        check_numbers(arguments)
        with standard_output_free(vars(arguments).values()):
            return int(arguments.command(arguments))
    except (LearningError, WeldgateError, OSError) as error:
        print(f"weldgate-models: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


@contextmanager
def _progress(text: str, total: int) -> Iterator[Callable[[], None]]:
    from rich.progress import Progress

    with Progress(disable=not sys.stderr.isatty()) as progress:
        task = progress.add_task(text, total=total)
        yield lambda: progress.advance(task)


def _inspector(arguments: argparse.Namespace) -> "Inspector":
    from station.inspection.loading import load_inspector
    from station.settings.file import load
    from station.settings.model import for_images

    settings = for_images(SHIPPED) if arguments.settings is None else load(arguments.settings)
    files = {"path": arguments.model, "ring_path": arguments.ring}
    named = {key: value for key, value in files.items() if value is not None}
    model = settings.model.model_copy(update=named)
    return load_inspector(settings.model_copy(update={"model": model}))[0]


def _one_thread() -> None:
    """Train in one thread: two of them wait for each other by spinning, which stalls a busy machine."""
    import torch

    torch.set_num_threads(1)


def _print(line: str) -> None:
    print(line, flush=True)


def _train(arguments: argparse.Namespace) -> int:
    from models.classifier.card import Decisions
    from models.classifier.plan import Plan
    from models.classifier.train import train
    from models.paper.train import PaperPlan, train_paper

    found: list[Decisions] = []
    for seed in arguments.seeds:
        out = arguments.out if len(arguments.seeds) == 1 else arguments.out / f"seed-{seed}"
        if arguments.protocol == "paper":
            paper = train_paper(arguments.datasets, out, replace(PaperPlan(), seed=seed), _print)
            held_out, seconds = paper.held_out, paper.seconds
        else:
            plan = Plan(seed=seed) if arguments.steps is None else Plan(seed=seed, steps=arguments.steps)
            card = train(
                arguments.datasets,
                out=out,
                version=arguments.version,
                plan=plan,
                kinds=[KINDS[name] for name in arguments.kinds],
                report=_print,
            )
            held_out, seconds = card.held_out, card.seconds
        found.append(held_out)
        _print(f"seed {seed}: {json.dumps(asdict(held_out))} in {seconds:.0f} s, in {out}")
    if len(found) > 1:
        for name in ("precision", "recall", "f2"):
            values = sorted(getattr(one, name) for one in found)
            middle = values[len(values) // 2]
            _print(f"held-out {name}: {values[0]:.4f} to {values[-1]:.4f}, median {middle:.4f}")
    return 0


def _fine_tune(arguments: argparse.Namespace) -> int:
    from models.classifier.train import fine_tune

    card = fine_tune(
        arguments.lot,
        model=None if arguments.from_nothing else arguments.model,
        out=arguments.out,
        version=arguments.version,
        seed=arguments.seed,
        report=_print,
    )
    _print(f"test parts: {json.dumps(asdict(card.held_out))}")
    return 0


def _train_ring(arguments: argparse.Namespace) -> int:
    from models.data.lot import data_hash
    from models.ring.card import command, ring_card
    from models.ring.evaluate import as_json, evaluate_ring, lines
    from models.ring.export import export_ring
    from models.ring.pictures import read_pictures, split
    from models.ring.train import RingPlan, train_ring
    from station.classify.onnx import RingNetwork

    _one_thread()
    out, left_out = arguments.out, arguments.leave_out
    training, held_out = split(read_pictures(arguments.lots), left_out)
    given = {"seed": arguments.seed, "steps": arguments.steps}
    plan = replace(RingPlan(), **{name: value for name, value in given.items() if value is not None})
    network = train_ring(training, plan, out, _print)
    digest = data_hash(arguments.lots)
    export_ring(network, out / "ring.onnx", arguments.version, digest)
    outcomes = evaluate_ring(held_out, RingNetwork(out / "ring.onnx"))
    card = ring_card(
        version=arguments.version,
        data_hash=digest,
        lots=arguments.lots,
        command=command(arguments.lots, seed=plan.seed, steps=plan.steps, leave_out=left_out),
        plan=plan,
        weights=sum(p.numel() for p in network.parameters()),
        held_out=as_json(outcomes),
    )
    (out / "RING.md").write_text(card, encoding="utf-8")
    for line in lines(outcomes):
        _print(line)
    return 0


def _evaluate_ring(arguments: argparse.Namespace) -> int:
    from models.ring.evaluate import evaluate_ring, lines
    from models.ring.pictures import read_pictures
    from station.classify.onnx import RingNetwork

    pictures = read_pictures(arguments.lots)
    network = RingNetwork(arguments.ring)
    with _progress("looking for rings", len(pictures)) as advance:
        outcomes = evaluate_ring(pictures, network, advance)
    for line in lines(outcomes):
        _print(line)
    return 0


def _train_seen(arguments: argparse.Namespace) -> int:
    from models.data.lot import data_hash
    from models.seen.export import export_seen
    from models.seen.train import SeenPlan, seen_card, train_seen

    _one_thread()
    plan = SeenPlan(steps=arguments.steps, seed=arguments.seed, leave_out=tuple(arguments.leave_out))
    network, found = train_seen(arguments.lots, plan, _print)
    arguments.out.mkdir(parents=True, exist_ok=True)
    digest = data_hash(arguments.lots)
    export_seen(network, arguments.out / "seen.onnx", arguments.version, digest)
    (arguments.out / "SEEN.md").write_text(seen_card(arguments.version, digest, plan, found))
    _print(f"hidden columns that are recognised, by cover: {json.dumps(found)}")
    return 0


def _evaluate(arguments: argparse.Namespace) -> int:
    from models.data.folder import FolderKind, folder_kind
    from models.data.rendered import read_rendered
    from models.evaluation.evaluate import evaluate_crops
    from models.evaluation.report import lines, write_report

    kinds = [folder_kind(folder) for folder in arguments.data]
    if FolderKind.LOT in kinds and len(kinds) > 1:
        raise LearningError(f"{len(kinds)} folders, one of them a lot. Name one lot, or only datasets")
    inspector = _inspector(arguments)
    absent: list[str] = []
    boxes: list[str] = []
    if kinds[0] is FolderKind.LOT:
        found = _evaluate_lot(arguments.data[0], inspector)
    else:
        _, held_out, _ = read_rendered(arguments.data, ())
        found = evaluate_crops(held_out, inspector.classifier, inspector.thresholds)
        absent = [name for name, label in KINDS.items() if not held_out.count(label)]
        if arguments.boxes:
            boxes = _boxes(arguments.data, held_out, inspector, [KINDS[name] for name in arguments.kinds])
    missing = [f"no crops show: {', '.join(absent)}"] if absent else []
    for line in [*lines(found), *missing, *boxes]:
        _print(line)
    if arguments.report is not None:
        facts = {
            "data": ", ".join(map(str, arguments.data)),
            "model": inspector.card.version,
            "model SHA-256": inspector.card.file_hash,
        }
        if absent:
            facts["not in the data"] = ", ".join(absent)
        if boxes:
            facts["boxes"] = "; ".join(boxes)
        write_report(found, arguments.report, "weldgate: evaluation", facts)
        _print(f"report: {arguments.report / 'report.html'}")
    return 0


def _evaluate_lot(lot: Path, inspector: "Inspector") -> "Evaluation":
    from models.data.lot import read_labels
    from models.evaluation.evaluate import evaluate_lot

    with _progress("judging", len(read_labels(lot))) as advance:
        return evaluate_lot(lot, inspector, advance)


def _boxes(
    datasets: Sequence[Path], held_out: "Crops", inspector: "Inspector", kinds: Sequence[int]
) -> list[str]:
    from models.evaluation.detection import evaluate_boxes

    found = evaluate_boxes(datasets, held_out, inspector.classifier, kinds)
    by_kind = ", ".join(f"{name} {value:.3f}" for name, value in found.by_kind.items())
    decided = found.as_decision
    figures = f"precision {decided.precision:.3f}, recall {decided.recall:.3f}, F2 {decided.f2:.3f}"
    return [f"boxes: mAP50 {found.map50:.3f} ({by_kind})", f"boxes as decision: {figures}"]


def _export(arguments: argparse.Namespace) -> int:
    from models.classifier.quantize import quantize
    from models.data.rendered import read_rendered

    training, held_out, _ = read_rendered(arguments.datasets, ())
    f2 = quantize(arguments.model, arguments.out, training, held_out)
    figures = f"F2 {f2.int8:.4f} in 8 bits, {f2.float32:.4f} in float32"
    _print(f"{arguments.out}: {figures}, on {len(held_out)} held-out crops")
    return 0


def _drift(arguments: argparse.Namespace) -> int:
    from models.evaluation.drift import DRIFTS, STRENGTHS, drift, write_drift
    from station.classify.drift import read_reference
    from station.classify.onnx import APPEARANCE_SIZE, Classifier

    classifier = Classifier(arguments.model)
    path = arguments.reference
    reference = None if path is None else read_reference(path, classifier.card.file_hash, APPEARANCE_SIZE)
    with _progress("drifting", len(DRIFTS) * len(STRENGTHS)) as advance:
        steps = drift(arguments.lot, classifier, reference, advance)
    for step in steps:
        figures = f"recall {step.segments.recall:.3f}  F2 {step.segments.f2:.3f}  alarms {step.alarms:.0%}"
        _print(f"{step.drift:26} {step.strength:4.2f}  {figures}")
    write_drift(steps, arguments.out)
    _print(str(arguments.out / "drift.png"))
    return 0


def _first_day(arguments: argparse.Namespace) -> int:
    from models.classifier.reference import make_reference
    from models.evaluation.first_day import first_day
    from station.classify.drift import write_reference
    from station.replay.files import sources

    inspector = _inspector(arguments)
    files = [source.path for source in sources(arguments.paths)]
    with _progress("judging", len(files)) as advance:
        found = first_day(files, inspector, inspector.card.novelty_limit, advance)
    if arguments.reference is not None and found.good:
        write_reference(arguments.reference, make_reference(found.looks, inspector.card.file_hash))
    for line in found.lines():
        _print(line)
    if arguments.reference is not None:
        nothing = "no reference written. Remove or correct the parts named above"
        _print(f"reference: {arguments.reference}" if found.good else nothing)
    return 0 if found.good else 1


COMMANDS = {
    "train": _train,
    "fine-tune": _fine_tune,
    "train-ring": _train_ring,
    "evaluate-ring": _evaluate_ring,
    "train-seen": _train_seen,
    "evaluate": _evaluate,
    "export": _export,
    "drift": _drift,
    "first-day": _first_day,
}

if __name__ == "__main__":
    sys.exit(main())

"""Command line of the learning room."""

import argparse
import json
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.errors import LearningError
from station.defects import KINDS as DEFECT_KINDS
from station.errors import WeldgateError

if TYPE_CHECKING:
    from station.inspection.inspector import Inspector

SHIPPED = Path(__file__).resolve().parent / "shipped"
KINDS = {kind.name: label for label, kind in enumerate(DEFECT_KINDS, start=1)}
"""Label of each kind of defect."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 1 something was found wrong, 2 it could not be done."""
    arguments = _parser().parse_args(argv)
    try:
        _check_numbers(arguments)
        return int(arguments.command(arguments))
    except (LearningError, WeldgateError, OSError) as error:
        print(f"weldgate-models: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _check_numbers(arguments: argparse.Namespace) -> None:
    for name, low, high in (("steps", 1, 10**7), ("seed", 0, 2**31 - 1), ("seeds", 0, 2**31 - 1)):
        values = getattr(arguments, name, None)
        for value in values if isinstance(values, list) else [values]:
            if value is not None and not low <= value <= high:
                raise LearningError(f"--{name} is {value}; {low} to {high} is allowed")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="weldgate-models", description="Train, judge and release the networks."
    )
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, command: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text)
        sub.set_defaults(command=command)
        return sub

    train = add("train", _train, "train the classifier on rendered crops and release it with its card")
    train.add_argument(
        "datasets", type=Path, nargs="+", metavar="DATASET", help="folders made by weldgate-synth dataset"
    )
    _run_options(train)
    train.add_argument(
        "--seeds",
        type=int,
        nargs="+",
        default=[0],
        metavar="N",
        help="one run each; more than one: a folder each",
    )
    train.add_argument("--steps", type=int, metavar="N", help="batches of 64 (default: 5000)")
    train.add_argument(
        "--kinds",
        nargs="+",
        choices=KINDS,
        default=list(KINDS),
        help="kinds of defect to learn (default: all)",
    )
    train.add_argument(
        "--protocol",
        choices=("weldgate", "paper"),
        default="weldgate",
        help="paper: OK against NOK as published",
    )

    fine = add(
        "fine-tune",
        _fine_tune,
        "train on a line's own labelled images: 10 px window, balanced, 70/15/15 %% by part",
    )
    fine.add_argument("lot", type=Path, metavar="LOT", help="folder with labels.json and frames/")
    _run_options(fine)
    fine.add_argument(
        "--model",
        type=Path,
        default=SHIPPED / "weldgate.onnx",
        metavar="FILE",
        help="where to begin (default: the shipped one)",
    )
    fine.add_argument("--from-nothing", action="store_true", help="train a new network on these images alone")
    fine.add_argument("--seed", type=int, default=0, help="seed of split and training (default: %(default)s)")

    ring = add("train-ring", _train_ring, "train the ring network and export it")
    ring.add_argument("lots", type=Path, nargs="+", metavar="LOT", help="folders made by weldgate-synth part")
    _run_options(ring)
    ring.add_argument("--seed", type=int, default=0, help="seed of the run (default: %(default)s)")

    pair = add(
        "pair-rings",
        _pair_rings,
        "join two ring networks in one file: exact where the first sees, seeing where it is blind",
    )
    pair.add_argument("first", type=Path, metavar="FILE", help="the more exact network")
    pair.add_argument("second", type=Path, metavar="FILE", help="the network that sees more")
    _run_options(pair)

    judge = add(
        "evaluate",
        _evaluate,
        "judge labelled parts, or the crops held out of datasets, with the station's own code",
    )
    judge.add_argument(
        "data",
        type=Path,
        nargs="+",
        metavar="DATA",
        help="one lot with labels.json and frames/, or rendered datasets",
    )
    _network_options(judge)
    judge.add_argument(
        "--report", type=Path, metavar="DIR", help="write report.html and evaluation.json there"
    )
    judge.add_argument(
        "--boxes", action="store_true", help="judge the boxes of the defect map too (datasets only)"
    )
    judge.add_argument(
        "--kinds",
        nargs="+",
        choices=KINDS,
        default=list(KINDS),
        help="kinds whose boxes are looked for (default: all)",
    )

    export = add("export", _export, "make the 8-bit file of a classifier, kept only if it judges as well")
    export.add_argument("model", type=Path, metavar="FILE", help="float32 classifier")
    export.add_argument(
        "datasets",
        type=Path,
        nargs="+",
        metavar="DATASET",
        help="rendered datasets: to calibrate, and to judge both files",
    )
    export.add_argument("--out", type=Path, required=True, metavar="FILE", help="where the 8-bit file goes")

    drift = add("drift", _drift, "show how accuracy and the alarm answer to a line that drifts")
    drift.add_argument("lot", type=Path, metavar="LOT", help="folder with labels.json and frames/")
    drift.add_argument(
        "--model",
        type=Path,
        default=SHIPPED / "weldgate.onnx",
        metavar="FILE",
        help="classifier (default: the shipped one)",
    )
    drift.add_argument(
        "--reference", type=Path, metavar="FILE", help="of other, good parts of the same line, from first-day"
    )
    drift.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="where drift.png and drift.json go"
    )

    first = add(
        "first-day", _first_day, "check thresholds and images with OK parts alone, before production begins"
    )
    first.add_argument(
        "paths",
        type=Path,
        nargs="+",
        metavar="PATH",
        help="images of parts known to be OK, or folders of them",
    )
    first.add_argument(
        "--reference",
        type=Path,
        metavar="FILE",
        help="write the look of these parts, for model.reference_path: at least 20 parts",
    )
    _network_options(first)
    return parser


def _run_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="where the ONNX file and its card go"
    )
    parser.add_argument(
        "--version", default="0.1.0", help="version written into the file (default: %(default)s)"
    )


def _network_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-c",
        "--settings",
        type=Path,
        metavar="FILE",
        help="settings file (default: the shipped limits and networks)",
    )
    parser.add_argument("--model", type=Path, metavar="FILE", help="classifier, in place of the settings'")
    parser.add_argument("--ring", type=Path, metavar="FILE", help="ring network, in place of the settings'")


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
    named = {
        key: value
        for key, value in (("path", arguments.model), ("ring_path", arguments.ring))
        if value is not None
    }
    return load_inspector(settings.model_copy(update={"model": settings.model.model_copy(update=named)}))[0]


def _say(line: str) -> None:
    print(line, flush=True)


def _train(arguments: argparse.Namespace) -> int:
    from models.classifier.fit import Plan
    from models.classifier.train import train
    from models.paper.train import PaperPlan, train_paper

    cards = []
    for seed in arguments.seeds:
        out = arguments.out if len(arguments.seeds) == 1 else arguments.out / f"seed-{seed}"
        if arguments.protocol == "paper":
            card = train_paper(arguments.datasets, out, replace(PaperPlan(), seed=seed), _say)
        else:
            plan = Plan(seed=seed) if arguments.steps is None else Plan(seed=seed, steps=arguments.steps)
            card = train(
                arguments.datasets, out, arguments.version, plan, [KINDS[k] for k in arguments.kinds], _say
            )
        cards.append(card)
        _say(f"seed {seed}: {json.dumps(card['held_out'])} in {card['seconds']:.0f} s, in {out}")
    if len(cards) > 1:
        for key in ("precision", "recall", "f2"):
            values = sorted(card["held_out"][key] for card in cards)
            _say(
                f"held out {key}: {values[0]:.4f} to {values[-1]:.4f}, median {values[len(values) // 2]:.4f}"
            )
    return 0


def _fine_tune(arguments: argparse.Namespace) -> int:
    from models.classifier.train import fine_tune

    model = None if arguments.from_nothing else arguments.model
    card = fine_tune(arguments.lot, model, arguments.out, arguments.version, arguments.seed, _say)
    _say(f"test parts: {json.dumps(card['held_out'])}")
    return 0


def _train_ring(arguments: argparse.Namespace) -> int:
    from models.data.labelled import data_hash
    from models.ring.export import export_ring
    from models.ring.train import RingPlan, ring_card, train_ring

    plan = RingPlan(seed=arguments.seed)
    network, error_px = train_ring(arguments.lots, plan, _say)
    arguments.out.mkdir(parents=True, exist_ok=True)
    digest = data_hash(arguments.lots)
    export_ring(network, arguments.out / "ring.onnx", arguments.version, digest)
    (arguments.out / "RING.md").write_text(ring_card(arguments.version, digest, plan, error_px))
    return 0


def _pair_rings(arguments: argparse.Namespace) -> int:
    from models.ring.pair import pair_rings

    pair_rings(arguments.first, arguments.second, arguments.out, arguments.version)
    return 0


def _evaluate(arguments: argparse.Namespace) -> int:
    from models.data.labelled import read_labels
    from models.data.rendered import read_rendered
    from models.evaluation.evaluate import evaluate_crops, evaluate_lot
    from models.evaluation.report import lines, write_report

    inspector = _inspector(arguments)
    rendered = [
        (folder / "manifest.json").is_file() and not (folder / "labels.json").is_file()
        for folder in arguments.data
    ]
    facts = {
        "data": ", ".join(map(str, arguments.data)),
        "model": inspector.card.version,
        "model SHA-256": inspector.card.file_hash,
    }
    extra: list[str] = []
    if all(rendered):
        held = read_rendered(arguments.data)[1]
        found = evaluate_crops(held, inspector.classifier, inspector.thresholds)
        if arguments.boxes:
            extra = _boxes(arguments.data, held, inspector, [KINDS[k] for k in arguments.kinds])
    elif len(arguments.data) == 1:
        with _progress("judging", len(read_labels(arguments.data[0]))) as advance:
            found = evaluate_lot(arguments.data[0], inspector, advance)
    else:
        raise LearningError("name one lot with labels.json, or rendered datasets only")
    for line in [*lines(found), *extra]:
        _say(line)
    if arguments.report is not None:
        write_report(
            found,
            arguments.report,
            "weldgate: evaluation",
            {**facts, **({"boxes": "; ".join(extra)} if extra else {})},
        )
        _say(f"report: {arguments.report / 'report.html'}")
    return 0


def _boxes(datasets: list[Path], held: Any, inspector: "Inspector", kinds: list[int]) -> list[str]:
    from models.evaluation.detection import evaluate_boxes

    found = evaluate_boxes(datasets, held, inspector.classifier, kinds)
    kinds_text = ", ".join(f"{name} {value:.3f}" for name, value in found.by_kind.items())
    decided = found.as_decision
    return [
        f"boxes: mAP50 {found.map50:.3f} ({kinds_text})",
        f"boxes as decision: precision {decided.precision:.3f}, recall {decided.recall:.3f}, F2 {decided.f2:.3f}",
    ]


def _export(arguments: argparse.Namespace) -> int:
    from models.classifier.quantize import quantize
    from models.data.rendered import read_rendered

    training, held, _ = read_rendered(arguments.datasets)
    f2 = quantize(arguments.model, arguments.out, training, held)
    _say(
        f"{arguments.out}: F2 {f2['int8']:.4f} in 8 bits, {f2['float32']:.4f} in float32, on {len(held)} crops held out"
    )
    return 0


def _drift(arguments: argparse.Namespace) -> int:
    from models.evaluation.drift import DRIFTS, STRENGTHS, drift, write_drift
    from station.classify.drift import read_reference
    from station.classify.onnx import LOOK, Classifier

    classifier = Classifier(arguments.model)
    path = arguments.reference
    reference = None if path is None else read_reference(path, classifier.card.file_hash, LOOK)
    with _progress("drifting", len(DRIFTS) * len(STRENGTHS)) as advance:
        steps = drift(arguments.lot, classifier, reference, advance)
    for s in steps:
        _say(
            f"{s.drift:26} {s.strength:4.2f}  recall {s.segments.recall:.3f}  F2 {s.segments.f2:.3f}  alarms {s.alarms:.0%}"
        )
    write_drift(steps, arguments.out)
    _say(str(arguments.out / "drift.png"))
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
        _say(line)
    if arguments.reference is not None:
        _say(
            f"reference: {arguments.reference}"
            if found.good
            else "no reference written: remove or correct the parts named above"
        )
    return 0 if found.good else 1


if __name__ == "__main__":
    sys.exit(main())

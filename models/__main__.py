"""Command line of the learning room."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from models.errors import LearningError
from station.errors import WeldgateError

SHIPPED = Path(__file__).resolve().parent / "shipped"


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 2 it could not be done."""
    parser = argparse.ArgumentParser(prog="weldgate-models", description="Train the networks on rendered parts.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, command, text in (
        ("train", _train, "train the classifier and export it with its card"),
        ("train-ring", _train_ring, "train the ring network and export it"),
    ):
        sub = commands.add_parser(name, help=text, description=text)
        sub.add_argument("lots", type=Path, nargs="+", metavar="LOT", help="folders made by weldgate-synth part")
        sub.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the ONNX file goes")
        sub.add_argument("--version", default="0.1.0", help="version written into the file (default: %(default)s)")
        sub.add_argument("--seed", type=int, default=0, help="seed of the run (default: %(default)s)")
        sub.set_defaults(command=command)
    sub = commands.add_parser("evaluate", help="judge a labelled lot with the shipped networks and the station's own code")
    sub.add_argument("lot", type=Path, metavar="LOT", help="folder with labels.json and frames/")
    sub.add_argument("--model", type=Path, default=SHIPPED / "weldgate.onnx", metavar="FILE", help="classifier (default: the shipped one)")
    sub.add_argument("--ring", type=Path, default=SHIPPED / "ring.onnx", metavar="FILE", help="ring network (default: the shipped one)")
    sub.set_defaults(command=_evaluate)
    arguments = parser.parse_args(argv)
    try:
        return int(arguments.command(arguments))
    except (LearningError, WeldgateError, OSError) as error:
        print(f"weldgate-models: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _evaluate(arguments: argparse.Namespace) -> int:
    from rich.progress import Progress

    from models.data import read_labels
    from models.evaluate import evaluate
    from station.classify.onnx import Classifier, RingNetwork
    from station.inspection import Inspector
    from station.settings import ModelSettings, QualitySettings, WeldSettings

    inspector = Inspector(RingNetwork(arguments.ring), Classifier(arguments.model), WeldSettings(), QualitySettings(), ModelSettings())
    with Progress(disable=not sys.stderr.isatty()) as progress:
        task = progress.add_task("judging", total=len(read_labels(arguments.lot)))
        outcome = evaluate(arguments.lot, inspector, lambda: progress.advance(task))
    for line in outcome.lines():
        _say(line)
    return 0


def _say(line: str) -> None:
    print(line, flush=True)


def _train(arguments: argparse.Namespace) -> int:
    from models.train import Plan, train

    card = train(arguments.lots, arguments.out, arguments.version, Plan(seed=arguments.seed), _say)
    print(json.dumps(card["held_out"]))
    return 0


def _train_ring(arguments: argparse.Namespace) -> int:
    from models.data import data_hash
    from models.export import export_ring
    from models.ring import RingPlan, ring_card, train_ring

    plan = RingPlan(seed=arguments.seed)
    network, error_px = train_ring(arguments.lots, plan, _say)
    arguments.out.mkdir(parents=True, exist_ok=True)
    digest = data_hash(arguments.lots)
    export_ring(network, arguments.out / "ring.onnx", arguments.version, digest)
    (arguments.out / "RING.md").write_text(ring_card(arguments.version, digest, plan, error_px))
    return 0


if __name__ == "__main__":
    sys.exit(main())

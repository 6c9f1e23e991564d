"""Command line of the learning room."""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from models.errors import LearningError
from station.errors import WeldgateError


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 2 it could not be done."""
    parser = argparse.ArgumentParser(prog="weldgate-models", description="Train the networks on rendered parts.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, command, text in (
        ("train", _train, "train the classifier and export it with its card"),
        ("train-ring", _train_ring, "train the ring network and export it"),
    ):
        sub = commands.add_parser(name, help=text, description=text)
        sub.add_argument("lot", type=Path, metavar="LOT", help="folder made by weldgate-synth part")
        sub.add_argument("--out", type=Path, required=True, metavar="DIR", help="where the ONNX file goes")
        sub.add_argument("--version", default="0.1.0", help="version written into the file (default: %(default)s)")
        sub.add_argument("--seed", type=int, default=0, help="seed of the run (default: %(default)s)")
        sub.set_defaults(command=command)
    arguments = parser.parse_args(argv)
    try:
        return int(arguments.command(arguments))
    except (LearningError, WeldgateError, OSError) as error:
        print(f"weldgate-models: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _say(line: str) -> None:
    print(line, flush=True)


def _train(arguments: argparse.Namespace) -> int:
    from models.train import Plan, train

    card = train(arguments.lot, arguments.out, arguments.version, Plan(seed=arguments.seed), _say)
    print(json.dumps(card["held_out"]))
    return 0


def _train_ring(arguments: argparse.Namespace) -> int:
    from models.data import data_hash
    from models.export import export_ring
    from models.ring import RingPlan, train_ring

    network = train_ring(arguments.lot, RingPlan(seed=arguments.seed), _say)
    arguments.out.mkdir(parents=True, exist_ok=True)
    export_ring(network, arguments.out / "ring.onnx", arguments.version, data_hash(arguments.lot))
    return 0


if __name__ == "__main__":
    sys.exit(main())

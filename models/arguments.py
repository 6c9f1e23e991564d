"""Arguments of `weldgate-models`: commands, options, help texts, and the ranges of numbers."""

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path

from models.errors import LearningError
from station.defects import KINDS as DEFECT_KINDS
from station.files.destination import output_path
from station.numbers import whole_option

SHIPPED = Path(__file__).resolve().parent / "shipped"
"""Folder of the shipped networks and their cards."""
KINDS = {kind.name: label for label, kind in enumerate(DEFECT_KINDS, start=1)}
"""Label of each kind of defect."""
RANGES = {"steps": (1, 10**7), "seed": (0, 2**31 - 1), "seeds": (0, 2**31 - 1)}
"""Smallest and largest value of each number."""

Command = Callable[[argparse.Namespace], int]


def check_numbers(arguments: argparse.Namespace) -> None:
    """Raise LearningError if a number is out of range."""
    for name, (low, high) in RANGES.items():
        values = getattr(arguments, name, None)
        for value in values if isinstance(values, list) else [values]:
            if value is not None and not low <= value <= high:
                raise LearningError(f"--{name} is {value}; {low} to {high} is allowed")


def make_parser(commands: Mapping[str, Command]) -> argparse.ArgumentParser:
    """Return the parser; `arguments.command` is one of `commands`."""
    parser = argparse.ArgumentParser(
        prog="weldgate-models", description="Train, evaluate and release the networks."
    )
    added = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, text: str) -> argparse.ArgumentParser:
        sub = added.add_parser(name, help=text, description=text)
        sub.set_defaults(command=commands[name])
        return sub

    _train(add("train", "train the classifier on rendered crops and write its file and its card"))
    _fine_tune(
        add("fine-tune", "train on a line's own images: 10 px window, balanced, split by part 70/15/15 %%")
    )
    _train_ring(add("train-ring", "train the ring network and write its file and its card"))
    _evaluate_ring(add("evaluate-ring", "find the rings of labelled pictures with the station's own code"))
    _train_seen(
        add("train-seen", "train the network that says what is hidden, and write its file and its card")
    )
    _evaluate(
        add(
            "evaluate",
            "judge labelled parts, or the held-out crops of datasets, with the station's own code",
        )
    )
    _export(add("export", "write the 8-bit file of a classifier, kept only if it judges as well"))
    _drift(add("drift", "show how accuracy and alarm respond to a line that drifts"))
    _first_day(add("first-day", "check thresholds and images with OK parts alone, before production begins"))
    return parser


def _train(train: argparse.ArgumentParser) -> None:
    train.add_argument(
        "datasets", type=Path, nargs="+", metavar="DATASET", help="folders made by weldgate-synth dataset"
    )
    _run_options(train)
    train.add_argument(
        "--seeds",
        type=whole_option,
        nargs="+",
        default=[0],
        metavar="N",
        help="make one run for each seed; more than one: each in a folder of its own",
    )
    train.add_argument(
        "--steps", type=whole_option, metavar="N", help="number of batches of 64 (default: 5000)"
    )
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
        help="way to train; paper: OK against NOK as published (default: %(default)s)",
    )


def _fine_tune(fine: argparse.ArgumentParser) -> None:
    _lot(fine)
    _run_options(fine)
    _model(fine, "classifier to begin with (default: the shipped one)")
    fine.add_argument("--from-nothing", action="store_true", help="train a new network on these images alone")
    fine.add_argument(
        "--seed", type=whole_option, default=0, help="seed of split and training (default: %(default)s)"
    )


def _train_ring(ring: argparse.ArgumentParser) -> None:
    _ring_lots(ring)
    _run_options(ring)
    ring.add_argument("--seed", type=whole_option, default=0, help="seed of the run (default: %(default)s)")
    ring.add_argument(
        "--steps", type=whole_option, metavar="N", help="number of batches of 8 (default: 9000)"
    )
    ring.add_argument(
        "--leave-out",
        nargs="+",
        default=[],
        metavar="NAME",
        help="hold out these weld families and sheet finishes (default: every tenth picture)",
    )


def _evaluate_ring(ring: argparse.ArgumentParser) -> None:
    _ring_lots(ring)
    ring.add_argument(
        "--ring",
        type=Path,
        default=SHIPPED / "ring.onnx",
        metavar="FILE",
        help="ring network (default: the shipped one)",
    )


def _ring_lots(ring: argparse.ArgumentParser) -> None:
    ring.add_argument(
        "lots", type=Path, nargs="+", metavar="LOT", help="folders of pictures at 52 µm/px with masks"
    )


def _train_seen(seen: argparse.ArgumentParser) -> None:
    help_of_lots = "folders of labelled frames at 13 µm/px, made by weldgate-synth pictures or part"
    seen.add_argument("lots", type=Path, nargs="+", metavar="LOT", help=help_of_lots)
    _run_options(seen)
    seen.add_argument("--seed", type=whole_option, default=0, help="seed of the run (default: %(default)s)")
    seen.add_argument(
        "--steps",
        type=whole_option,
        default=3000,
        metavar="N",
        help="number of batches (default: %(default)s)",
    )
    not_shown = "do not show these covers in training, and judge by them"
    seen.add_argument("--leave-out", nargs="+", default=[], metavar="COVER", help=not_shown)


def _evaluate(judge: argparse.ArgumentParser) -> None:
    judge.add_argument(
        "data",
        type=Path,
        nargs="+",
        metavar="DATA",
        help="one lot (labels.json and frames/), or datasets made by weldgate-synth dataset",
    )
    _network_options(judge)
    judge.add_argument(
        "--report", type=Path, metavar="DIR", help="write report.html and evaluation.json into this folder"
    )
    judge.add_argument(
        "--boxes", action="store_true", help="evaluate the boxes of the defect map too (datasets only)"
    )
    judge.add_argument(
        "--kinds",
        nargs="+",
        choices=KINDS,
        default=list(KINDS),
        help="kinds of defect whose boxes are evaluated (default: all)",
    )


def _export(export: argparse.ArgumentParser) -> None:
    export.add_argument("model", type=Path, metavar="FILE", help="float32 classifier")
    export.add_argument(
        "datasets",
        type=Path,
        nargs="+",
        metavar="DATASET",
        help="datasets with which the file is calibrated and both files are judged",
    )
    export.add_argument("--out", type=output_path, required=True, metavar="FILE", help="8-bit file to write")


def _drift(drift: argparse.ArgumentParser) -> None:
    _lot(drift)
    _model(drift, "classifier (default: the shipped one)")
    drift.add_argument(
        "--reference",
        type=Path,
        metavar="FILE",
        help="reference of other good parts of the same line, written by first-day",
    )
    drift.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for drift.png and drift.json"
    )


def _first_day(first: argparse.ArgumentParser) -> None:
    first.add_argument(
        "paths",
        type=Path,
        nargs="+",
        metavar="PATH",
        help="images of parts known to be OK, or folders of them",
    )
    first.add_argument(
        "--reference",
        type=output_path,
        metavar="FILE",
        help="write the appearance of these parts for model.reference_path; needs at least 20 parts",
    )
    _network_options(first)


def _lot(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("lot", type=Path, metavar="LOT", help="folder with labels.json and frames/")


def _model(parser: argparse.ArgumentParser, text: str) -> None:
    parser.add_argument("--model", type=Path, default=SHIPPED / "weldgate.onnx", metavar="FILE", help=text)


def _run_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the ONNX file and its card"
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
    parser.add_argument(
        "--model", type=Path, metavar="FILE", help="use this classifier instead of the one in the settings"
    )
    parser.add_argument(
        "--ring", type=Path, metavar="FILE", help="use this ring network instead of the one in the settings"
    )

"""Arguments of `weldgate-synth`: commands, options and help texts."""

import argparse
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from station.files.destination import output_path
from station.numbers import number_option, whole_option
from synth.part.switches import Switch
from synth.recipes.named import LINE, RECIPES

Command = Callable[[argparse.Namespace], None]

RECIPE_FILE = f"""
A file for --recipe is TOML with what differs from the named recipe:

    base = "wide"                  # the recipe that it changes, in place of --base
    ok_weight = 0.5                # how many parts of a lot are OK, relative to the weights below

    [bead]                         # a group of ranges; lengths in mm, angles in degrees
    half_width_mm = [0.35, 0.5]    # drawn evenly between both ends

    [hole]                         # each kind of defect is a group as well
    weight = 0.3                   # how many parts of a lot show it
    count = [1, 4]

Groups: {", ".join(LINE.groups())}.
Their keys, with bounds and meaning, are in synth/part and synth/defects. The keys of older files, which stood
outside of groups (gap_mm = [0.1, 0.2]), are still read.
"""


def make_parser(commands: Mapping[str, Command]) -> argparse.ArgumentParser:
    """Return the parser; `arguments.command` is one of `commands`."""
    parser = argparse.ArgumentParser(prog="weldgate-synth", description="Render welds with exact labels.")
    added = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, summary: str, **texts: Any) -> Any:
        command = added.add_parser(
            name,
            help=summary[0].lower() + summary[1:].removesuffix("."),
            description=summary,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            **texts,
        )
        command.set_defaults(command=commands[name])
        return command

    dataset = add("dataset", "Render labelled crops for training.", epilog=RECIPE_FILE)
    _out_option(dataset, "DIR", "write into this folder; a killed run continues where it stopped")
    each = (
        "make this many crops: half of them OK, the kinds of defect in equal numbers (default: %(default)s)"
    )
    dataset.add_argument("--count", type=whole_option, default=5000, help=each)
    straight = "render the paper's straight pieces instead of rings cut as the station cuts them"
    dataset.add_argument("--flat", action="store_true", help=straight)
    dataset.add_argument("--heights", action="store_true", help="write height maps as well")
    processes = "render in this many processes (default: %(default)s)"
    dataset.add_argument(
        "--workers", type=whole_option, default=os.cpu_count() or 1, metavar="N", help=processes
    )
    dataset.add_argument(
        "--scheduler", metavar="ADDRESS", help="render on this Dask cluster, started with --preload weldgate"
    )
    _recipe_options(dataset, "wide")
    _off_option(dataset)

    part = add("part", "Render whole parts as camera frames: a lot.", epilog=RECIPE_FILE)
    _out_option(part, "DIR", "write into this folder; a killed run continues where it stopped")
    part.add_argument(
        "--count", type=whole_option, default=1, help="render this many parts (default: %(default)s)"
    )
    window = "render only the window round the ring: faster, and enough for training"
    part.add_argument("--ring-only", action="store_true", help=window)
    strips = "write the unwrapped strips as well, and masks of frames and strips"
    part.add_argument("--strips", action="store_true", help=strips)
    _recipe_options(part, "line", "--mix")
    _off_option(part)

    pictures = add("pictures", "Draw welds of many kinds without ray tracing: a lot.")
    _out_option(pictures, "DIR", "write into this folder; a killed run continues where it stopped")
    pictures.add_argument(
        "--count", type=whole_option, default=1000, help="draw this many (default: %(default)s)"
    )
    use = (
        "ring: rings of any size at 52 um/px; plugs: those of turned plugs; crops: the line's at 13 um/px "
        "(default: %(default)s)"
    )
    pictures.add_argument("--use", choices=("ring", "plugs", "crops"), default="ring", help=use)
    pictures.add_argument(
        "--seed", type=whole_option, default=0, help="draw with this seed: same seed, same pictures"
    )
    pictures.add_argument(
        "--workers", type=whole_option, default=os.cpu_count() or 1, metavar="N", help=processes
    )

    sheet = add("sheet", "Make a contact sheet of a dataset, or of the switches.", epilog=RECIPE_FILE)
    of_switches = "show this dataset; without it, the same crops with each switch off in turn"
    sheet.add_argument("dataset", type=Path, nargs="?", metavar="DIR", help=of_switches)
    _out_option(sheet, "PNG", "write the sheet to this file")
    _recipe_options(sheet, "paper")

    measurement = add("measurement", "Analyse a 3D surface measurement of a weld.")
    read = "read this x3p, opd, sur, … or npy file (default: the shipped one)"
    measurement.add_argument("file", type=Path, nargs="?", metavar="FILE", help=read)
    measurement.add_argument(
        "--step-um", type=number_option, metavar="UM", help="state the step of an npy file"
    )
    measurement.add_argument("--figure", type=output_path, metavar="PNG", help="draw a figure to this file")

    artificial = add("artificial", "Make an artificial surface measurement, as the shipped one.")
    _out_option(artificial, "X3P", "write the measurement to this file")
    seed = "make the measurement of this seed (default: %(default)s, that of the shipped one)"
    artificial.add_argument("--seed", type=whole_option, default=1, help=seed)

    calibrate = add("calibrate", "Find the roughness of weld and partners in images.", epilog=RECIPE_FILE)
    images = "compare with these crops or strips of OK welds, 128 px high, or with folders of them"
    calibrate.add_argument("images", type=Path, nargs="+", metavar="PATH", help=images)
    renders = "render this many crops of each roughness (default: %(default)s)"
    calibrate.add_argument("--renders", type=whole_option, default=5, help=renders)
    calibrate.add_argument("--figure", type=output_path, metavar="PNG", help="draw a figure to this file")
    calibrate.add_argument(
        "--out", type=output_path, metavar="TOML", help="write a recipe file with the roughness"
    )
    _recipe_options(calibrate, "paper")
    _off_option(calibrate)
    return parser


def _out_option(parser: argparse.ArgumentParser, kind: str, text: str) -> None:
    kind_of_path = Path if kind == "DIR" else output_path
    parser.add_argument("--out", type=kind_of_path, required=True, metavar=kind, help=text)


def _recipe_options(parser: argparse.ArgumentParser, default: str, *other: str) -> None:
    add, names = parser.add_argument, sorted(RECIPES)
    add(
        "--seed",
        type=whole_option,
        default=0,
        help="draw with this seed: same seed, same bytes (default: %(default)s)",
    )
    add("--base", *other, choices=names, default=default, help="draw from this recipe (default: %(default)s)")
    add("--recipe", type=Path, metavar="FILE", help="change the recipe by this TOML file, see below")
    add(
        "--measurement",
        type=Path,
        metavar="FILE",
        help="use this 3D measurement of an OK weld, not the shipped one",
    )
    add("--step-um", type=number_option, metavar="UM", help="state the step of an npy measurement")


def _off_option(parser: argparse.ArgumentParser) -> None:
    text = f"switch off some of {', '.join(Switch)}; see the paper's section 3.4 (default: all are on)"
    parser.add_argument("--off", nargs="+", default=[], metavar="NAME", help=text)

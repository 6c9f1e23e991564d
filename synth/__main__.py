"""Command line of the generator."""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from synth.errors import SynthError
from synth.part.recipe import Recipe
from synth.part.switches import Switch, without
from synth.recipes.named import LINE, RECIPES
from synth.recipes.toml_file import read_recipe

if TYPE_CHECKING:
    from rich.progress import Progress

    from synth.measured.spectrum import WeldModel

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

LIMITS = {"seed": (0, 2**31 - 1), "count": (1, 10**7), "workers": (1, 256), "renders": (1, 100)}
"""Smallest and largest value of an option."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command. Returns 0 if it was done, 2 if not."""
    arguments = _parser().parse_args(argv)
    try:
        arguments.command(arguments)
    except (SynthError, OSError) as error:
        print(f"weldgate-synth: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="weldgate-synth", description="Render welds with exact labels.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, run: Callable[[argparse.Namespace], None], summary: str, **texts: Any) -> Any:
        command = commands.add_parser(
            name,
            help=summary[0].lower() + summary[1:].removesuffix("."),
            description=summary,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            **texts,
        )
        command.set_defaults(command=run)
        return command

    dataset = add("dataset", _dataset, "Render labelled crops for training.", epilog=RECIPE_FILE)
    _out_option(dataset, "DIR", "write into this folder; a killed run continues where it stopped")
    each = (
        "make this many crops: half of them OK, the kinds of defect in equal numbers (default: %(default)s)"
    )
    dataset.add_argument("--count", type=int, default=5000, help=each)
    straight = "render the paper's straight pieces instead of rings cut as the station cuts them"
    dataset.add_argument("--flat", action="store_true", help=straight)
    dataset.add_argument("--heights", action="store_true", help="write height maps as well")
    processes = "render in this many processes (default: %(default)s)"
    dataset.add_argument("--workers", type=int, default=os.cpu_count() or 1, metavar="N", help=processes)
    dataset.add_argument(
        "--scheduler", metavar="ADDRESS", help="render on this Dask cluster, started with --preload weldgate"
    )
    _recipe_options(dataset, "wide")
    _off_option(dataset)

    part = add("part", _part, "Render whole parts as camera frames: a lot.", epilog=RECIPE_FILE)
    _out_option(part, "DIR", "write into this folder; a killed run continues where it stopped")
    part.add_argument("--count", type=int, default=1, help="render this many parts (default: %(default)s)")
    window = "render only the window round the ring: faster, and enough for training"
    part.add_argument("--ring-only", action="store_true", help=window)
    strips = "write the unwrapped strips as well, and masks of frames and strips"
    part.add_argument("--strips", action="store_true", help=strips)
    _recipe_options(part, "line", "--mix")
    _off_option(part)

    pictures = add("pictures", _pictures, "Draw welds of many kinds without ray tracing: a lot.")
    _out_option(pictures, "DIR", "write into this folder; a killed run continues where it stopped")
    pictures.add_argument("--count", type=int, default=1000, help="draw this many (default: %(default)s)")
    use = "ring: rings of any size at 52 um/px; crops: the line's at 13 um/px (default: %(default)s)"
    pictures.add_argument("--use", choices=("ring", "crops"), default="ring", help=use)
    pictures.add_argument("--seed", type=int, default=0, help="draw with this seed: same seed, same pictures")
    pictures.add_argument("--workers", type=int, default=os.cpu_count() or 1, metavar="N", help=processes)

    sheet = add("sheet", _sheet, "Make a contact sheet of a dataset, or of the switches.", epilog=RECIPE_FILE)
    of_switches = "show this dataset; without it, the same crops with each switch off in turn"
    sheet.add_argument("dataset", type=Path, nargs="?", metavar="DIR", help=of_switches)
    _out_option(sheet, "PNG", "write the sheet to this file")
    _recipe_options(sheet, "paper")

    measurement = add("measurement", _measurement, "Analyse a 3D surface measurement of a weld.")
    read = "read this x3p, opd, sur, … or npy file (default: the shipped one)"
    measurement.add_argument("file", type=Path, nargs="?", metavar="FILE", help=read)
    measurement.add_argument("--step-um", type=float, metavar="UM", help="state the step of an npy file")
    measurement.add_argument("--figure", type=Path, metavar="PNG", help="draw a figure to this file")

    artificial = add("artificial", _artificial, "Make an artificial surface measurement, as the shipped one.")
    _out_option(artificial, "X3P", "write the measurement to this file")
    seed = "make the measurement of this seed (default: %(default)s, that of the shipped one)"
    artificial.add_argument("--seed", type=int, default=1, help=seed)

    calibrate = add(
        "calibrate", _calibrate, "Find the roughness of weld and partners in images.", epilog=RECIPE_FILE
    )
    images = "compare with these crops or strips of OK welds, 128 px high, or with folders of them"
    calibrate.add_argument("images", type=Path, nargs="+", metavar="PATH", help=images)
    renders = "render this many crops of each roughness (default: %(default)s)"
    calibrate.add_argument("--renders", type=int, default=5, help=renders)
    calibrate.add_argument("--figure", type=Path, metavar="PNG", help="draw a figure to this file")
    calibrate.add_argument("--out", type=Path, metavar="TOML", help="write a recipe file with the roughness")
    _recipe_options(calibrate, "paper")
    _off_option(calibrate)
    return parser


def _out_option(parser: argparse.ArgumentParser, kind: str, text: str) -> None:
    parser.add_argument("--out", type=Path, required=True, metavar=kind, help=text)


def _recipe_options(parser: argparse.ArgumentParser, default: str, *other: str) -> None:
    add, names = parser.add_argument, sorted(RECIPES)
    add(
        "--seed",
        type=int,
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
    add("--step-um", type=float, metavar="UM", help="state the step of an npy measurement")


def _off_option(parser: argparse.ArgumentParser) -> None:
    text = f"switch off some of {', '.join(Switch)}; see the paper's section 3.4 (default: all are on)"
    parser.add_argument("--off", nargs="+", default=[], metavar="NAME", help=text)


def _checked(arguments: argparse.Namespace) -> tuple[Recipe, frozenset[Switch], "WeldModel"]:
    """Return the recipe, the switches and the weld model that the options name."""
    _check_numbers(arguments)
    recipe = RECIPES[arguments.base]
    if arguments.recipe is not None:
        recipe = read_recipe(arguments.recipe, recipe)
    switches = without(getattr(arguments, "off", []))
    from synth.measured.measurement import SHIPPED, read_measurement
    from synth.measured.spectrum import derive

    return recipe, switches, derive(read_measurement(arguments.measurement or SHIPPED, arguments.step_um))


def _check_numbers(arguments: argparse.Namespace) -> None:
    for name, (low, high) in LIMITS.items():
        value = getattr(arguments, name, low)
        if not low <= value <= high:
            raise SynthError(f"--{name} is {value}; {low} to {high} is allowed")


@contextmanager
def _progress() -> "Iterator[Progress]":
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, disable=not sys.stderr.isatty()) as progress:
        yield progress


def _dataset(arguments: argparse.Namespace) -> None:
    from synth.output.dataset import Order, cluster, workers, write_dataset

    recipe, switches, model = _checked(arguments)
    order = Order(
        seed=arguments.seed,
        count=arguments.count,
        recipe=recipe,
        switches=switches,
        is_straight=arguments.flat,
        has_heights=arguments.heights,
    )
    pool = cluster(arguments.scheduler) if arguments.scheduler else workers(arguments.workers)
    with pool as executor, _progress() as progress:
        task = progress.add_task("rendering", total=arguments.count)
        advance = partial(progress.advance, task)
        write_dataset(arguments.out, order, model, executor=executor, done=advance)
    print(f"{arguments.count} crops in {arguments.out}")


def _part(arguments: argparse.Namespace) -> None:
    from synth.output.lot import LotOrder, write_lot

    recipe, switches, model = _checked(arguments)
    order = LotOrder(
        seed=arguments.seed,
        count=arguments.count,
        recipe=recipe,
        switches=switches,
        is_whole=not arguments.ring_only,
        has_strips=arguments.strips,
    )
    with _progress() as progress:
        task = progress.add_task("rendering", total=arguments.count)
        write_lot(arguments.out, order, model, lambda: progress.advance(task))
    print(f"{arguments.count} parts in {arguments.out}")


def _pictures(arguments: argparse.Namespace) -> None:
    from synth.heightfield.part import ORDERS
    from synth.output.pictures import write_pictures

    _check_numbers(arguments)
    with _progress() as progress:
        task = progress.add_task("drawing", total=arguments.count)
        write_pictures(
            arguments.out,
            ORDERS[arguments.use],
            seed=arguments.seed,
            count=arguments.count,
            workers=arguments.workers,
            done=lambda: progress.advance(task),
        )
    print(f"{arguments.count} pictures in {arguments.out}")


def _sheet(arguments: argparse.Namespace) -> None:
    from synth.output.sheet import dataset_sheet, switch_sheet

    if arguments.dataset is not None:
        dataset_sheet(arguments.dataset, arguments.out)
    else:
        recipe, _, model = _checked(arguments)
        switch_sheet(arguments.seed, recipe, model, arguments.out)
    print(arguments.out)


def _measurement(arguments: argparse.Namespace) -> None:
    from synth.measured.measurement import SHIPPED, read_measurement
    from synth.measured.spectrum import derive
    from synth.output.figures import measurement_figure

    measurement = read_measurement(arguments.file or SHIPPED, arguments.step_um)
    rows, columns = measurement.height_um.shape
    step = measurement.step_um
    size = f"{columns * step / 1000:.2f} x {rows * step / 1000:.2f} mm"
    print(f"map           {columns} x {rows} points, {size}, step {step:g} um")
    print(f"lost points   {measurement.lost:.1%}, filled")
    print(f"weld          turned by {measurement.turned_deg:.0f} degrees to lie along x")
    model = derive(measurement)
    last_row = model.first_row + model.shape[0]
    print(f"              {model.width_mm:.2f} mm wide, rows {model.first_row} to {last_row}")
    print(f"spectrum      {len(model.lines)} frequencies of at least 10 % of the largest amplitude")
    print(f"              dominant pitch {model.dominant_pitch_mm:.3f} mm")
    print(f"row shift     Gaussian, {model.shift.height_mm:+.3f} mm, sigma {model.shift.sigma_mm:.3f} mm")
    print(f"edge height   Gaussian, {model.edge.height_mm * 1000:.1f} um, sigma {model.edge.sigma_mm:.3f} mm")
    if arguments.figure is not None:
        measurement_figure(measurement, model, arguments.figure)
        print(f"figure        {arguments.figure}")


def _artificial(arguments: argparse.Namespace) -> None:
    from synth.measured.artificial import write_artificial

    _check_numbers(arguments)
    write_artificial(arguments.out, arguments.seed)
    print(arguments.out)


def _calibrate(arguments: argparse.Namespace) -> None:
    from synth.output.calibrate import ALPHAS, calibrate, read_crops
    from synth.output.figures import calibration_figure
    from synth.output.storage import write_text

    recipe, switches, model = _checked(arguments)
    crops = read_crops(arguments.images)
    with _progress() as progress:
        task = progress.add_task("rendering", total=ALPHAS.size)
        found = calibrate(
            crops,
            recipe,
            model,
            switches=switches,
            seed=arguments.seed,
            renders=arguments.renders,
            done=lambda: progress.advance(task),
        )
    alphas = {"alpha_weld": found.alpha_weld, "alpha_partner": found.alpha_partner}
    entry = "[surface]\n" + "".join(f"{key} = [{value}, {value}]\n" for key, value in alphas.items())
    print(entry, end="")
    if arguments.figure is not None:
        calibration_figure(found, arguments.figure)
    if arguments.out is not None:
        write_text(arguments.out, entry)


if __name__ == "__main__":
    sys.exit(main())

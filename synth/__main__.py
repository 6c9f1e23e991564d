"""Command line of the generator."""

import argparse
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from synth.errors import SynthError
from synth.part.part import Truth
from synth.part.recipe import RECIPES, Recipe, read_recipe
from synth.part.switches import Switch, without

if TYPE_CHECKING:
    from rich.progress import Progress

    from synth.measured.spectrum import WeldModel

SHARES = {
    "line": {Truth.OK: 0.4, Truth.HOLE: 0.3, Truth.MISSING_WELD: 0.3},
    "paper": {Truth.OK: 0.5, Truth.HOLE: 0.25, Truth.MISSING_WELD: 0.25},
    "dense": {Truth.OK: 0.25, Truth.HOLE: 0.45, Truth.MISSING_WELD: 0.3},
    "wide": {Truth.OK: 0.25, Truth.HOLE: 0.45, Truth.MISSING_WELD: 0.3},
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 2 it could not be done."""
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
    parser = argparse.ArgumentParser(prog="weldgate-synth", description="Rendered welds with exact labels.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    dataset = commands.add_parser("dataset", help="render labelled crops for training", description="Render crops of 128 x 128 px.")
    dataset.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder; a killed run goes on where it stopped")
    dataset.add_argument("--count", type=int, default=5000, help="half OK, a quarter hole, a quarter missing weld (default: %(default)s)")
    dataset.add_argument("--flat", action="store_true", help="the paper's straight crops; else arcs of rings as the station cuts them")
    dataset.add_argument("--heights", action="store_true", help="height maps beside the images")
    dataset.add_argument("--workers", type=int, default=os.cpu_count() or 1, metavar="N", help="processes (default: %(default)s)")
    dataset.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="send the work to a Dask cluster started with --preload weldgate",
    )
    _recipe_options(dataset, "wide")
    _off_option(dataset)
    dataset.set_defaults(command=_dataset)

    part = commands.add_parser("part", help="render parts as camera frames", description="Render parts with labels.")
    part.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the lot; a killed run goes on where it stopped")
    part.add_argument("--count", type=int, default=1, help="number of parts (default: %(default)s)")
    part.add_argument("--ring-only", action="store_true", help="only the window round the ring: faster, enough for training")
    part.add_argument("--strips", action="store_true", help="unwrapped strips too, and masks of frames and strips")
    _recipe_options(part, "line", "--mix")
    _off_option(part)
    part.set_defaults(command=_part)

    sheet = commands.add_parser("sheet", help="contact sheet of a dataset, or of the switches")
    sheet.add_argument("dataset", type=Path, nargs="?", metavar="DIR", help="left out: the same crops with each switch off in turn")
    sheet.add_argument("--out", type=Path, required=True, metavar="PNG")
    _recipe_options(sheet, "paper")
    sheet.set_defaults(command=_sheet)

    measurement = commands.add_parser("measurement", help="what a surface measurement gives", description="Read it and derive the weld.")
    measurement.add_argument("file", type=Path, nargs="?", metavar="FILE", help="x3p, opd, sur, … or npy (default: the shipped one)")
    measurement.add_argument("--step-um", type=float, metavar="UM", help="step of an npy file")
    measurement.add_argument("--figure", type=Path, metavar="PNG", help="where the figure goes")
    measurement.set_defaults(command=_measurement)

    calibrate = commands.add_parser("calibrate", help="roughness from images", description="Find the alphas whose renders are nearest.")
    calibrate.add_argument(
        "images", type=Path, nargs="+", metavar="PATH", help="crops or strips of OK welds, 128 px high, or folders of them"
    )
    calibrate.add_argument("--renders", type=int, default=5, help="renders of each alpha (default: %(default)s)")
    calibrate.add_argument("--figure", type=Path, metavar="PNG", help="where the figure goes")
    calibrate.add_argument("--out", type=Path, metavar="TOML", help="where the recipe entry goes")
    _recipe_options(calibrate, "paper")
    _off_option(calibrate)
    calibrate.set_defaults(command=_calibrate)
    return parser


def _recipe_options(parser: argparse.ArgumentParser, default: str, *other: str) -> None:
    parser.add_argument("--seed", type=int, default=0, help="same seed, same bytes (default: %(default)s)")
    parser.add_argument("--base", *other, dest="base", choices=sorted(RECIPES), default=default, help="recipe (default: %(default)s)")
    parser.add_argument("--recipe", type=Path, metavar="FILE", help="TOML with what differs from it")
    parser.add_argument("--measurement", type=Path, metavar="FILE", help="3D measurement of an OK weld (default: the shipped one)")
    parser.add_argument("--step-um", type=float, metavar="UM", help="step of an npy measurement")


def _off_option(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--off", nargs="+", default=[], metavar="NAME", help=f"switch off: {', '.join(Switch)}; the paper's section 3.4 (default: all on)"
    )


def _checked(arguments: argparse.Namespace) -> tuple[Recipe, frozenset[Switch], "WeldModel"]:
    for name, low, high in (("seed", 0, 2**31 - 1), ("count", 1, 10**7), ("workers", 1, 256), ("renders", 1, 100)):
        value = getattr(arguments, name, low)
        if not low <= value <= high:
            raise SynthError(f"--{name} is {value}; {low} to {high} is allowed")
    recipe = RECIPES[arguments.base]
    if arguments.recipe is not None:
        recipe = read_recipe(arguments.recipe, recipe)
    switches = without(getattr(arguments, "off", []))
    from synth.measured.measurement import SHIPPED, read_measurement
    from synth.measured.spectrum import derive

    return recipe, switches, derive(read_measurement(arguments.measurement or SHIPPED, arguments.step_um))


@contextmanager
def _progress() -> "Iterator[Progress]":
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, disable=not sys.stderr.isatty()) as progress:
        yield progress


def _dataset(arguments: argparse.Namespace) -> None:
    from synth.output.dataset import Order, cluster, workers, write_dataset

    recipe, switches, model = _checked(arguments)
    order = Order(arguments.seed, arguments.count, recipe, switches, arguments.flat, arguments.heights)
    pool = cluster(arguments.scheduler) if arguments.scheduler else workers(arguments.workers)
    with pool as executor, _progress() as progress:
        task = progress.add_task("rendering", total=arguments.count)
        write_dataset(arguments.out, order, model, executor, lambda images: progress.advance(task, images))
    print(f"{arguments.count} crops in {arguments.out}")


def _part(arguments: argparse.Namespace) -> None:
    from synth.output.lot import write_lot

    recipe, switches, model = _checked(arguments)
    with _progress() as progress:
        task = progress.add_task("rendering", total=arguments.count)
        write_lot(
            arguments.out,
            arguments.seed,
            arguments.count,
            SHARES[arguments.base],
            recipe,
            switches,
            model,
            not arguments.ring_only,
            arguments.strips,
            lambda: progress.advance(task),
        )
    print(f"{arguments.count} parts in {arguments.out}")


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
    print(f"map           {columns} x {rows} points, {columns * step / 1000:.2f} x {rows * step / 1000:.2f} mm, step {step:g} um")
    print(f"lost points   {measurement.lost:.1%}, filled")
    print(f"weld          turned by {measurement.turned_deg:.0f} degrees to lie along x")
    model = derive(measurement)
    print(f"              {model.width_mm:.2f} mm wide, rows {model.first_row} to {model.first_row + model.shape[0]}")
    print(f"spectrum      {len(model.lines)} frequencies of at least 10 % of the largest amplitude")
    print(f"              dominant pitch {model.dominant_pitch_mm:.3f} mm")
    print(f"row shift     Gaussian, {model.shift.height_mm:+.3f} mm, sigma {model.shift.sigma_mm:.3f} mm")
    print(f"edge height   Gaussian, {model.edge.height_mm * 1000:.1f} um, sigma {model.edge.sigma_mm:.3f} mm")
    if arguments.figure is not None:
        measurement_figure(measurement, model, arguments.figure)
        print(f"figure        {arguments.figure}")


def _calibrate(arguments: argparse.Namespace) -> None:
    from synth.output.calibrate import ALPHAS, calibrate, read_crops
    from synth.output.figures import calibration_figure
    from synth.output.storage import write_text

    recipe, switches, model = _checked(arguments)
    crops = read_crops(arguments.images)
    with _progress() as progress:
        task = progress.add_task("rendering", total=ALPHAS.size)
        found = calibrate(crops, recipe, switches, model, arguments.seed, arguments.renders, lambda: progress.advance(task))
    entry = f"alpha_weld = [{found.alpha_weld}, {found.alpha_weld}]\nalpha_partner = [{found.alpha_partner}, {found.alpha_partner}]\n"
    print(entry, end="")
    if arguments.figure is not None:
        calibration_figure(found, arguments.figure)
    if arguments.out is not None:
        write_text(arguments.out, entry)


if __name__ == "__main__":
    sys.exit(main())

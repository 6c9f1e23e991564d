"""Command line of the generator."""

import argparse
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import TYPE_CHECKING

from station.files.destination import standard_output_free
from synth.arguments import make_parser
from synth.errors import SynthError
from synth.part.recipe import Recipe
from synth.part.switches import Switch, without
from synth.recipes.named import RECIPES
from synth.recipes.toml_file import read_recipe

if TYPE_CHECKING:
    from rich.progress import Progress

    from synth.measured.spectrum import WeldModel

LIMITS = {"seed": (0, 2**31 - 1), "count": (1, 10**7), "workers": (1, 256), "renders": (1, 100)}
"""Smallest and largest value of an option."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command. Returns 0 if it was done, 2 if not."""
    arguments = make_parser(COMMANDS).parse_args(argv)
    try:
        with standard_output_free(vars(arguments).values()):
            arguments.command(arguments)
    except (SynthError, OSError) as error:
        print(f"weldgate-synth: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return 0


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


COMMANDS = {
    "dataset": _dataset,
    "part": _part,
    "pictures": _pictures,
    "sheet": _sheet,
    "measurement": _measurement,
    "artificial": _artificial,
    "calibrate": _calibrate,
}
"""Functions of the commands."""


if __name__ == "__main__":
    sys.exit(main())

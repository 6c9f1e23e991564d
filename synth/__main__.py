"""Command line of the generator."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from synth.errors import SynthError
from synth.part import Truth

SHARES = {
    "line": {Truth.OK: 0.4, Truth.HOLE: 0.3, Truth.MISSING_WELD: 0.3},
    "dense": {Truth.OK: 0.25, Truth.HOLE: 0.45, Truth.MISSING_WELD: 0.3},
    "wide": {Truth.OK: 0.25, Truth.HOLE: 0.45, Truth.MISSING_WELD: 0.3},
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 2 it could not be done."""
    parser = argparse.ArgumentParser(prog="weldgate-synth", description="Rendered welds with exact labels.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    part = commands.add_parser(
        "part", help="render parts as camera frames with labels", description="Render parts as camera frames with labels."
    )
    part.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the lot; a killed run goes on where it stopped")
    part.add_argument("--count", type=int, default=1, help="number of parts (default: %(default)s)")
    part.add_argument("--seed", type=int, default=0, help="seed of the lot (default: %(default)s)")
    part.add_argument(
        "--mix",
        choices=sorted(SHARES),
        default="line",
        help="line: few defects a part; dense: many; wide: many, on all kinds of surfaces (default: %(default)s)",
    )
    part.add_argument("--ring-only", action="store_true", help="only the window round the ring: faster, enough for training")
    part.set_defaults(command=_part)
    arguments = parser.parse_args(argv)
    try:
        return int(arguments.command(arguments))
    except (SynthError, OSError) as error:
        print(f"weldgate-synth: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


def _part(arguments: argparse.Namespace) -> int:
    if arguments.count < 1:
        raise SynthError(f"--count is {arguments.count}; at least 1 is needed")
    if not 0 <= arguments.seed < 2**31:
        raise SynthError(f"--seed is {arguments.seed}; 0 to 2147483647 is allowed")
    from rich.progress import Progress

    from synth.dataset import write_lot
    from synth.recipe import DENSE, WIDE, Recipe

    recipe = {"line": Recipe(), "dense": DENSE, "wide": WIDE}[arguments.mix]
    with Progress(disable=not sys.stderr.isatty()) as progress:
        task = progress.add_task("rendering", total=arguments.count)
        write_lot(
            arguments.out,
            arguments.seed,
            arguments.count,
            SHARES[arguments.mix],
            recipe,
            not arguments.ring_only,
            lambda: progress.advance(task),
        )
    print(f"{arguments.count} parts in {arguments.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main())

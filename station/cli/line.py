"""`weldgate line`: runs a simulated line with its PLC against a station, with faults on request.

The simulated line is imported when the command runs, so that all other commands start fast.
"""

import argparse
from collections.abc import Sequence
from typing import Any

from station.numbers import number_option, port_option, whole_option


def add_line_options(line: argparse.ArgumentParser) -> None:
    """Add the options of `weldgate line` to its parser."""
    line.add_argument(
        "--mode",
        choices=("server", "client"),
        default="server",
        help="Modbus role of the station (default: %(default)s)",
    )
    line.add_argument(
        "--host",
        default="127.0.0.1",
        help="server: address of the station; client: own address (default: %(default)s)",
    )
    line.add_argument(
        "--port",
        type=port_option,
        default=1502,
        metavar="PORT",
        help="TCP port (default: %(default)s)",
    )
    line.add_argument(
        "--parts", type=whole_option, default=24, metavar="N", help="number of parts (default: %(default)s)"
    )
    line.add_argument(
        "--pace",
        type=number_option,
        default=0.0,
        metavar="S",
        help="seconds between parts (default: no pause)",
    )
    line.add_argument(
        "--accept-simulated", action="store_true", help="accept verdicts on frames of an emulated camera"
    )
    line.add_argument(
        "--fault",
        nargs="+",
        default=[],
        metavar="NAME",
        help="inject these faults at random; quote names that contain spaces",
    )
    line.add_argument("--knob", dest="fault", nargs="+", default=argparse.SUPPRESS, help=argparse.SUPPRESS)
    line.add_argument("--list-faults", action=_ListFaults, help="print the names of all faults and exit")
    line.add_argument(
        "--seed", type=whole_option, default=0, metavar="N", help="seed of the faults (default: %(default)s)"
    )


def run_line_command(arguments: argparse.Namespace) -> int:
    """Run the line and return exit code 0. Raises LineError."""
    import asyncio

    from station.plc.simulated.run import LineRun, run_line

    run = LineRun(
        mode=arguments.mode,
        host=arguments.host,
        port=arguments.port,
        parts=arguments.parts,
        pace_s=arguments.pace,
        accept_simulated=arguments.accept_simulated,
        faults=tuple(arguments.fault),
        seed=arguments.seed,
    )
    asyncio.run(run_line(run))
    return 0


class _ListFaults(argparse.Action):
    """Prints the faults and ends, as --version does."""

    def __init__(self, option_strings: Sequence[str], dest: str, **options: Any) -> None:
        super().__init__(option_strings, dest, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        """Print one name per line."""
        from station.plc.simulated.line import Fault

        print("\n".join(Fault))
        parser.exit()

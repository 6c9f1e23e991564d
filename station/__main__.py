"""Command line of the station."""

import argparse
import gc
import logging
import os
import signal
import subprocess
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from station import __version__
from station.cli.records import add_commands
from station.errors import WeldgateError
from station.files.installation import SHIPPED_NETWORKS, room_command

SETTINGS = Path("station.toml")


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; 0 good, 1 something was found wrong, 2 it could not be done."""
    arguments = _parser().parse_args(argv)
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(message)s", stream=sys.stderr)
    try:
        return int(arguments.command(arguments))
    except (KeyboardInterrupt, BrokenPipeError):
        return 130
    except (WeldgateError, OSError) as error:
        print(f"weldgate: {error}", file=sys.stderr)
        return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="weldgate", description="Inline inspection of circular laser welds."
    )
    parser.add_argument("--version", action="version", version=f"weldgate {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, command: object, text: str, settings: bool = True) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text)
        sub.set_defaults(command=command)
        if settings:
            sub.add_argument(
                "-c",
                "--settings",
                type=Path,
                default=SETTINGS,
                metavar="FILE",
                help="settings file (default: %(default)s)",
            )
        return sub

    add("run", _run, "start engine and panel")
    add("engine", _engine, "run the inspection, without a window")
    add("panel", _panel, "open the operator's window")
    replay = add(
        "replay", _replay, "judge recorded images or records again: same code, no PLC", settings=False
    )
    replay.add_argument(
        "paths",
        nargs="+",
        type=Path,
        metavar="PATH",
        help="images, folders, archives: with these the line is compared",
    )
    replay.add_argument(
        "-c",
        "--settings",
        type=Path,
        metavar="FILE",
        help="settings file (default: the shipped limits and model)",
    )
    replay.add_argument(
        "--recipe", type=int, default=1, metavar="N", help="recipe of the settings (default: %(default)s)"
    )
    replay.add_argument("--model", type=Path, metavar="FILE", help="another classifier")
    replay.add_argument(
        "--um-per-px", type=float, metavar="UM", help="scale of the images (default: that of the settings)"
    )
    replay.add_argument("--processes", type=int, metavar="N", help="default: one for each core")
    replay.add_argument(
        "--json",
        type=Path,
        metavar="FILE",
        help="write all results as JSON; an interrupted run goes on where it stopped",
    )
    replay.add_argument("--csv", type=Path, metavar="FILE", help="write a table")
    replay.add_argument(
        "--report",
        type=Path,
        metavar="DIR",
        help="write report.html: counts, verdicts that flip and errors, with pictures",
    )
    replay.add_argument(
        "--truth",
        type=Path,
        metavar="FILE",
        help="what the images show, for --report: CSV with name and verdict, or JSON",
    )
    add("check", _check, "say what is wrong with settings, model, archive, camera and port, and what to do")
    add_commands(
        commands.add_parser(
            "records", help="list, verify, prune and export the records of an archive; edges on the bus"
        )
    )
    registers = add("registers", _registers, "print the register map", settings=False)
    registers.add_argument(
        "--format",
        choices=("md", "csv", "st", "scl", "symbols"),
        default="md",
        help="md, csv: the map; st: the block in IEC 61131-3; scl: for TIA Portal; symbols: for EcoStruxure (default: %(default)s)",
    )
    line = add("line", _line, "run a simulated line PLC against a station", settings=False)
    line.add_argument(
        "--mode", choices=("server", "client"), default="server", help="of the station (default: %(default)s)"
    )
    line.add_argument(
        "--host", default="127.0.0.1", help="server: of the station; client: our own (default: %(default)s)"
    )
    line.add_argument(
        "--port", type=int, choices=range(1, 65536), default=1502, metavar="PORT", help="default: %(default)s"
    )
    line.add_argument("--parts", type=int, default=24, help="default: %(default)s")
    line.add_argument(
        "--pace",
        type=float,
        default=0.0,
        metavar="S",
        help="seconds between parts (default: as fast as it goes)",
    )
    line.add_argument(
        "--accept-simulated", action="store_true", help="take verdicts on pictures of an emulated camera"
    )
    line.add_argument(
        "--knob",
        nargs="+",
        default=[],
        metavar="NAME",
        help="failures, rolled by the seed; a wrong name lists them",
    )
    line.add_argument("--seed", type=int, default=0, help="default: %(default)s")
    certificates = add(
        "certificates", _certificates, "make certificates for trials of Modbus/TCP Security", settings=False
    )
    certificates.add_argument(
        "folder", type=Path, metavar="DIR", help="where they go; keys are readable by the owner alone"
    )
    certificates.add_argument(
        "--host", default="127.0.0.1", help="name or address of the server (default: %(default)s)"
    )
    certificates.add_argument(
        "--days", type=int, default=90, help="how long they hold (default: %(default)s)"
    )
    return parser


def _engine(arguments: argparse.Namespace) -> int:
    from station.engine.startup import run_engine

    run_engine(arguments.settings)
    return 0


def _panel(arguments: argparse.Namespace) -> int:
    if hasattr(os, "SCHED_IDLE"):  # the window, also while it opens, takes the time that the engine leaves
        os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # its threads would spin
    gc.disable()  # there is nothing to collect while it opens
    from station.panel.app import run_panel

    gc.freeze()
    gc.enable()
    return run_panel(arguments.settings)


def _run(arguments: argparse.Namespace) -> int:
    from station.settings.file import load

    load(arguments.settings)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    panel = subprocess.Popen([*room_command("station"), "panel", "-c", str(arguments.settings)])
    try:
        return _engine(arguments)
    finally:
        panel.terminate()
        try:
            panel.wait(timeout=10)
        except subprocess.TimeoutExpired:
            panel.kill()
            panel.wait()


def _replay(arguments: argparse.Namespace) -> int:
    from station.cli.replay import run_replay

    return run_replay(arguments, SHIPPED_NETWORKS)


def _check(arguments: argparse.Namespace) -> int:
    from station.cli.check import check
    from station.errors import SettingsError
    from station.settings.adjustments import words

    problems = 0
    for name, problem in check(arguments.settings):
        print(f"{'ok  ' if problem is None else 'BAD '} {name}{'' if problem is None else ': ' + problem}")
        problems += problem is not None
    with suppress(SettingsError):  # said above
        for change in words(arguments.settings):
            print(f"note changed at the station, over {arguments.settings.name}: {change}")
    return 1 if problems else 0


def _registers(arguments: argparse.Namespace) -> int:
    from station.plc.block.dialects import scl, structured_text, symbols
    from station.plc.map.document import as_csv, as_markdown

    forms = {"md": as_markdown, "csv": as_csv, "st": structured_text, "scl": scl, "symbols": symbols}
    print(forms[arguments.format](), end="")
    return 0


def _line(arguments: argparse.Namespace) -> int:
    import asyncio

    from station.plc.simulated.run import LineRun, run_line

    run = LineRun(
        mode=arguments.mode,
        host=arguments.host,
        port=arguments.port,
        parts=arguments.parts,
        pace_s=arguments.pace,
        accept_simulated=arguments.accept_simulated,
        knobs=tuple(arguments.knob),
        seed=arguments.seed,
    )
    asyncio.run(run_line(run))
    return 0


def _certificates(arguments: argparse.Namespace) -> int:
    from station.plc.wire.certificates import make_certificates

    for path in make_certificates(arguments.folder, arguments.host, arguments.days):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())

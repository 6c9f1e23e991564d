"""The command `weldgate`: starts the station, judges recorded images, serves records and registers."""

import argparse
import gc
import io
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from station import __version__
from station.cli.line import add_line_options
from station.cli.records import add_commands
from station.errors import WeldgateError
from station.files.destination import output_path, standard_output_free
from station.files.installation import SHIPPED_NETWORKS, room_command
from station.log import start_log
from station.numbers import number_option, whole_option

SETTINGS = Path("station.toml")
"""Settings file that is used unless -c names another one."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code: 0 good, 1 a problem was found, 2 the command failed."""
    arguments = _parser().parse_args(argv)
    if isinstance(sys.stdout, io.TextIOWrapper):  # names of files and serials may hold anything
        sys.stdout.reconfigure(errors="backslashreplace")
    start_log()
    try:
        with standard_output_free(vars(arguments).values()):
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
        sub = commands.add_parser(name, help=text, description=_sentence(text))
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

    add("run", _run, "start the engine and open the operator's window")
    add("engine", _engine, "run the inspection without a window")
    add("panel", _panel, "open the operator's window for a running engine")
    replay = add(
        "replay",
        _replay,
        "judge recorded images or records again with the code of the line, but without a PLC",
        settings=False,
    )
    replay.add_argument(
        "paths",
        nargs="+",
        type=Path,
        metavar="PATH",
        help="images, folders or archives; results of an archive are compared with its recorded verdicts",
    )
    replay.add_argument(
        "-c",
        "--settings",
        type=Path,
        metavar="FILE",
        help="read settings from this file (default: use the shipped networks and the default limits)",
    )
    replay.add_argument(
        "--recipe", type=whole_option, default=1, metavar="N", help="use this recipe (default: %(default)s)"
    )
    replay.add_argument(
        "--model", type=Path, metavar="FILE", help="use this classifier instead of the configured one"
    )
    replay.add_argument(
        "--um-per-px",
        type=number_option,
        metavar="UM",
        help="set the scale of the images in µm per pixel, 9 to 65 (default: the scale in the settings)",
    )
    replay.add_argument(
        "--processes", type=whole_option, metavar="N", help="use this many processes (default: one per core)"
    )
    replay.add_argument(
        "--json",
        type=output_path,
        metavar="FILE",
        help="write all results as JSON (- for standard output); an interrupted run can be continued",
    )
    replay.add_argument(
        "--csv", type=output_path, metavar="FILE", help="write one row per image; - for standard output"
    )
    replay.add_argument(
        "--report",
        type=Path,
        metavar="DIR",
        help="write report.html with counts, flipped verdicts and errors, with images",
    )
    replay.add_argument(
        "--truth",
        type=Path,
        metavar="FILE",
        help="compare with the true verdicts in --report: CSV with the columns name and verdict, or JSON",
    )
    add(
        "check",
        _check,
        "check settings, models, archive, camera and PLC; report what is wrong and what to do",
    )
    add("commission", _commission, "make a code by which the first administrator can log in")
    add(
        "new-archive",
        _new_archive,
        "let a new archive begin, or another one be used: the next start takes archive.folder as it is",
    )
    about = "list, verify, prune, export and report the records of an archive"
    add_commands(commands.add_parser("records", help=about, description=_sentence(about)))
    registers = add(
        "registers", _registers, "print the register map or the PLC function block", settings=False
    )
    registers.add_argument(
        "--format",
        choices=("md", "csv", "block", "st", "scl", "plcopen", "openplc", "symbols"),
        default="md",
        help=(
            "choose the output: md or csv for the map, block for the inputs and outputs of the block, st for "
            "the block in IEC 61131-3 Structured Text, scl for TIA Portal, plcopen for CODESYS and TwinCAT "
            "(PLCopen XML), openplc for OpenPLC, symbols for EcoStruxure (default: %(default)s)"
        ),
    )
    line = add("line", _line, "run a simulated line with its PLC against a station", settings=False)
    add_line_options(line)
    certificates = add(
        "certificates", _certificates, "make test certificates for Modbus/TCP Security", settings=False
    )
    certificates.add_argument(
        "folder",
        type=Path,
        metavar="DIR",
        help="write the certificates here; only the owner can read the keys",
    )
    certificates.add_argument(
        "--host", default="127.0.0.1", help="name or address of the server (default: %(default)s)"
    )
    certificates.add_argument(
        "--days", type=whole_option, default=90, metavar="N", help="days of validity (default: %(default)s)"
    )
    return parser


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}."


def _engine(arguments: argparse.Namespace) -> int:
    return _run_engine(arguments.settings)


def _run_engine(settings: Path, at_end: Callable[[], None] = lambda: None) -> int:
    from station.engine.startup import run_engine

    run_engine(settings, at_end)
    return 0


def _panel(arguments: argparse.Namespace) -> int:
    if hasattr(os, "SCHED_IDLE"):  # the window only uses processor time that the engine does not need
        os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # more threads would busy-wait
    gc.disable()  # nothing to collect while the window opens
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
        return _run_engine(arguments.settings, panel.terminate)
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
    from station.cli.check import check, switched_off
    from station.errors import SettingsError
    from station.settings.adjustments import words

    problems = 0
    for name, problem in check(arguments.settings):
        print(f"{'ok  ' if problem is None else 'BAD '} {name}{'' if problem is None else ': ' + problem}")
        problems += problem is not None
    with suppress(SettingsError):  # reported above
        for off in switched_off(arguments.settings):
            print(f"off  {off}")
        for change in words(arguments.settings):
            print(f"note changed at the station, overrides {arguments.settings.name}: {change}")
    return 1 if problems else 0


def _commission(arguments: argparse.Namespace) -> int:
    from station.cli.commission import commission

    return commission(arguments.settings)


def _new_archive(arguments: argparse.Namespace) -> int:
    from station.engine.archive_identity import forget_archive
    from station.settings.file import load

    folder = load(arguments.settings).archive.folder
    aside = forget_archive(arguments.settings)
    print(f"{folder}: the next start takes it as the archive of this station")
    if aside is not None:
        print(f"the note about the archive until now: {aside}")
    return 0


def _registers(arguments: argparse.Namespace) -> int:
    from station.plc.block.dialects import scl, structured_text, symbols
    from station.plc.block.document import block_page
    from station.plc.block.openplc import openplc
    from station.plc.block.plcopen import plcopen
    from station.plc.map.document import as_csv, as_markdown

    forms = {
        "md": as_markdown,
        "csv": as_csv,
        "block": block_page,
        "st": structured_text,
        "scl": scl,
        "plcopen": plcopen,
        "openplc": openplc,
        "symbols": symbols,
    }
    print(forms[arguments.format](), end="")
    return 0


def _line(arguments: argparse.Namespace) -> int:
    from station.cli.line import run_line_command

    return run_line_command(arguments)


def _certificates(arguments: argparse.Namespace) -> int:
    from station.plc.wire.certificates import make_certificates

    for path in make_certificates(arguments.folder, arguments.host, arguments.days):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())

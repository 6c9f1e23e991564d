"""`weldgate records`: searches, verifies, prunes, exports and reports the records of an archive.

Each command imports what it needs, so that all commands, and the window above all, start fast.
"""

import argparse
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from getpass import getuser
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from station.analysis.forms import FORMATS
from station.errors import RecordError
from station.files.destination import find_destination, output_path
from station.numbers import number_option, whole_option

if TYPE_CHECKING:
    from station.archive.reader import Query, Row


def add_commands(records: argparse.ArgumentParser) -> None:
    """Add the commands of `weldgate records` to its parser."""
    commands = records.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, run: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=f"{text[0].upper()}{text[1:]}.")
        sub.set_defaults(command=run)
        sub.add_argument("folder", type=Path, metavar="FOLDER", help="archive folder")
        return sub

    _search_options(add("list", _list, "list all records, or those that match the options"))
    add("verify", _verify, "report missing, modified or deleted records and journal entries")
    prune = add(
        "prune",
        _prune,
        "delete frames and records past their retention; the engine does this every hour",
    )
    prune.add_argument(
        "-c",
        "--settings",
        type=Path,
        default=Path("station.toml"),
        metavar="FILE",
        help="settings file with the retention (default: %(default)s)",
    )
    prune.add_argument("--dry-run", action="store_true", help="print what would be deleted, delete nothing")
    clock = add("clock", _clock, "list the jumps of the clock, or say which dates at a jump are right")
    clock.add_argument(
        "--record",
        type=whole_option,
        metavar="N",
        help="the first record after the jump, if there are several",
    )
    clock.add_argument(
        "--right",
        choices=("before", "after", "both"),
        help="which dates are right: before the jump, after it, or both (the line paused)",
    )
    export = add("export", _export, "export records as a table, as Q-DAS file or as crops for training")
    export.add_argument(
        "target",
        type=output_path,
        metavar="TARGET",
        help="file to write, - for standard output, or folder for dataset and reviewed",
    )
    export.add_argument(
        "--format",
        choices=FORMATS,
        default="csv",
        help=(
            "csv, json, parquet: one row per record; dfq: Q-DAS; dataset: crops by the station's decisions; "
            "reviewed: crops by the reviews of two people (default: %(default)s)"
        ),
    )
    _search_options(export)
    report = add(
        "report", _report, "write a report with yield, findings by angle, trends, NOK parts and provenance"
    )
    report.add_argument(
        "target",
        type=output_path,
        metavar="FILE",
        help="file to write: .html (self-contained) or .pdf; - for HTML on standard output",
    )
    report.add_argument("--title", default="weldgate: report", help="title (default: %(default)s)")
    report.add_argument(
        "--truth",
        type=Path,
        metavar="FILE",
        help="compare with the true verdicts: CSV with the columns name (serial) and verdict, or JSON",
    )
    _search_options(report)
    add("bus", _bus, "print the log of the PLC bus: changed signals and broken rules of the handshake")


def _search_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--serial", metavar="TEXT", help="exact serial, or a prefix ending in *")
    parser.add_argument(
        "--since",
        type=_time,
        metavar="TIME",
        help="this time or later, such as 2026-11-22 or 2026-11-22T14:00; UTC unless it has an offset",
    )
    parser.add_argument("--until", type=_time, metavar="TIME", help="before this time")
    parser.add_argument("--verdict", choices=("OK", "NOK", "ERROR"), help="this verdict only")
    parser.add_argument("--reason", metavar="NAME", help="reason as the list prints it")
    parser.add_argument(
        "--segment",
        type=whole_option,
        choices=range(1, 22),
        metavar="N",
        help="segment, 1 to 21, whose score is at least --score",
    )
    parser.add_argument(
        "--score",
        type=number_option,
        metavar="P",
        help="minimum score of NOK, 0.05 or higher, of --segment or else of the worst segment",
    )
    parser.add_argument("--last", type=whole_option, metavar="N", help="the newest N records only")


def _time(text: str) -> datetime:
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is not a valid time; use YYYY-MM-DD or YYYY-MM-DDTHH:MM"
        ) from None
    return when.replace(tzinfo=UTC) if when.tzinfo is None else when.astimezone(UTC)


def _query(arguments: argparse.Namespace) -> "Query":
    from station.archive.reader import Query

    if arguments.last is not None and arguments.last < 1:
        raise RecordError(f"--last is {arguments.last}; 1 or more is needed")
    if arguments.score is not None and not 0 <= arguments.score <= 1:
        raise RecordError(f"--score is {arguments.score:g}; 0 to 1 is allowed")
    any_score = arguments.segment is not None and arguments.score is None
    return Query(
        serial=arguments.serial,
        since=arguments.since,
        until=arguments.until,
        verdict=arguments.verdict,
        reason=arguments.reason,
        segment=arguments.segment,
        min_score=0.05 if any_score else arguments.score,
        newest_first=arguments.last is not None,
        limit=arguments.last,
    )


def _list(arguments: argparse.Namespace) -> int:
    from station.archive.reader import find

    rows = find(arguments.folder, _query(arguments))
    for row in rows:
        print(_line(row))
    return 0


def _line(row: "Row") -> str:
    shown = {True: "", False: "not shown to the PLC", None: "unknown whether shown to the PLC"}
    notes = [
        row.reason or "",
        "" if row.purpose == "part" else row.purpose,
        shown[row.shown_to_plc] if row.purpose != "test" else "",
        "" if row.frame_state in ("kept", "none") else f"frame {row.frame_state}",
    ]
    time = row.grabbed_at[:19].replace("T", " ")
    worst = "     " if row.worst_score is None else f"{row.worst_score:5.3f}"
    text = ", ".join(note for note in notes if note)
    return f"{row.inspection_id:8d}  {time}  {row.verdict:5}  {worst}  {row.serial:20}  {text}".rstrip()


def _verify(arguments: argparse.Namespace) -> int:
    from station.archive.reader import find, verify
    from station.journal.journal import count_entries, verify_journal

    bad = 0
    for name, problem in chain(verify(arguments.folder), verify_journal(arguments.folder)):
        bad += 1
        print(f"weldgate: {arguments.folder}: {name}: {problem}", file=sys.stderr)
    records, journal = len(find(arguments.folder)), count_entries(arguments.folder)
    print(f"{records} records, {journal} journal entries, {bad} problems")
    return 1 if bad else 0


def _prune(arguments: argparse.Namespace) -> int:
    from station.engine.retention import prune_archive
    from station.settings.file import load

    keep = load(arguments.settings).archive.keep
    done = prune_archive(arguments.folder, keep, who=_user(), dry=arguments.dry_run)
    if done.doubt:
        print(
            f"weldgate: {arguments.folder}: nothing is deleted for its age: {done.doubt}. "
            "Say which dates are right: weldgate records clock",
            file=sys.stderr,
        )
    verb = "would delete" if arguments.dry_run else "deleted"
    print(f"{verb} {done.frames} frames, {done.records} records, {done.bytes / 1e6:.1f} MB")
    return 1 if done.doubt else 0


def _user() -> str:
    """Return the name of the user of the system who runs the command."""
    try:
        return getuser()
    except (KeyError, OSError, ImportError):
        return "unknown user"


def _clock(arguments: argparse.Namespace) -> int:
    from station.archive.age import Right, undecided
    from station.archive.prune import find_jumps
    from station.engine.retention import decide, read_clock

    clock = read_clock(arguments.folder)
    found = find_jumps(arguments.folder, clock)
    if arguments.right is not None:
        chosen = [jump for jump in found if arguments.record in (None, jump.number)]
        if len(chosen) != 1:
            numbers = ", ".join(str(jump.number) for jump in found) or "none"
            raise RecordError(
                f"{arguments.folder}: name one jump with --record; records after a jump: {numbers}"
            )
        decide(arguments.folder, chosen[0].number, Right(arguments.right), who=_user())
        clock = read_clock(arguments.folder)
    for jump in found:
        print(f"{jump}  {clock.decisions.get(jump.number, 'in doubt')}")
    left = undecided(found, clock)
    print(f"{len(found)} jumps, {len(left)} in doubt")
    return 1 if left else 0


def _export(arguments: argparse.Namespace) -> int:
    from station.analysis.export import export
    from station.archive.reader import read_records

    _check_target(arguments.target, is_folder=arguments.format in ("dataset", "reviewed"))
    bad = 0
    for path, problem in export(
        read_records(arguments.folder, _query(arguments)),
        arguments.folder,
        arguments.target,
        arguments.format,
    ):
        bad += 1
        print(f"weldgate: {path}: {problem}", file=sys.stderr)
    print(arguments.target)
    return 1 if bad else 0


def _check_target(target: Path, *, is_folder: bool = False) -> None:
    """Raise RecordError if an output cannot be written, before records are read for it."""
    destination = find_destination(target)
    if is_folder and destination.status is not None:
        return
    try:
        destination.check()
    except FileNotFoundError:
        raise RecordError(f"{target}: the folder does not exist; name a file in an existing folder") from None
    except OSError as error:
        raise RecordError(
            f"{target}: cannot be written ({error.strerror}); name a file in an existing folder"
        ) from None


def _report(arguments: argparse.Namespace) -> int:
    from station.analysis.report.page import report
    from station.analysis.report.pdf import write_pdf
    from station.analysis.truth import read_truth
    from station.archive.reader import read_records
    from station.files.durable import write_whole

    _check_target(arguments.target)
    found = read_records(arguments.folder, _query(arguments))
    entries = sorted(found, key=lambda entry: entry.row.inspection_id)
    truth = None if arguments.truth is None else read_truth(arguments.truth)
    page = report(entries, arguments.folder, arguments.title, truth)
    if arguments.target.suffix.lower() == ".pdf":
        write_pdf(page, arguments.target)
    else:
        write_whole(arguments.target, page.encode("utf-8", "backslashreplace"))
    print(arguments.target)
    return 1 if any(entry.problem is not None for entry in entries) else 0


def _bus(arguments: argparse.Namespace) -> int:
    from station.plc.bus_log import read_bus

    for edge in read_bus(arguments.folder):
        print(f"{edge.time}  {edge.by:7}  {edge.name:18} {edge.value!s:>6}  {edge.note}".rstrip())
    return 0

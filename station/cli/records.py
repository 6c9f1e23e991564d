"""`weldgate records`: finds, verifies, prunes and exports, for people and scripts.

What a command needs is imported by it: every command, the window above all, is to start fast.
"""

import argparse
import sys
from collections.abc import Callable
from datetime import UTC, datetime
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING

from station.analysis.forms import FORMATS
from station.errors import RecordError

if TYPE_CHECKING:
    from station.archive.reader import Row, Wanted


def add_commands(records: argparse.ArgumentParser) -> None:
    """The commands below `weldgate records`."""
    commands = records.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, run: Callable[[argparse.Namespace], int], text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text)
        sub.set_defaults(command=run)
        sub.add_argument("folder", type=Path, metavar="FOLDER", help="archive folder")
        return sub

    _search_options(add("list", _list, "list records, all or those that are looked for"))
    add("verify", _verify, "name missing, altered and taken out records")
    prune = add(
        "prune", _prune, "let go what the settings do not keep any longer; the engine does so every hour"
    )
    prune.add_argument(
        "-c",
        "--settings",
        type=Path,
        default=Path("station.toml"),
        metavar="FILE",
        help="default: %(default)s",
    )
    prune.add_argument("--dry-run", action="store_true", help="say what would go, change nothing")
    export = add("export", _export, "write records in another form")
    export.add_argument("target", type=Path, metavar="TARGET", help="file, or folder for dataset")
    export.add_argument("--format", choices=FORMATS, default="csv", help="default: %(default)s")
    _search_options(export)
    report = add("report", _report, "write a report: yield, findings by angle, trends, NOK parts, who judged")
    report.add_argument("target", type=Path, metavar="FILE", help=".html, with everything in it, or .pdf")
    report.add_argument("--title", default="weldgate: report", help="default: %(default)s")
    report.add_argument(
        "--truth",
        type=Path,
        metavar="FILE",
        help="what the parts are: CSV with name (serial) and verdict, or JSON",
    )
    _search_options(report)
    add("bus", _bus, "print the edges on the PLC bus, and what was against the rules")


def _search_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--serial", metavar="TEXT", help="exactly, or its beginning with * behind it")
    parser.add_argument(
        "--since",
        type=_time,
        metavar="TIME",
        help="2026-11-22, or 2026-11-22T14:00; UTC unless it says otherwise",
    )
    parser.add_argument("--until", type=_time, metavar="TIME", help="before this time")
    parser.add_argument("--verdict", choices=("OK", "NOK", "ERROR"))
    parser.add_argument("--reason", metavar="NAME", help="as the list prints it")
    parser.add_argument(
        "--segment",
        type=int,
        choices=range(1, 22),
        metavar="N",
        help="1 to 21, with a score of at least --score",
    )
    parser.add_argument(
        "--score", type=float, metavar="P", help="score of NOK of the segment, or of the worst; from 0.05"
    )
    parser.add_argument("--last", type=int, metavar="N", help="the newest only")


def _time(text: str) -> datetime:
    try:
        when = datetime.fromisoformat(text)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is no time; write 2026-11-22 or 2026-11-22T14:00"
        ) from None
    return when.replace(tzinfo=UTC) if when.tzinfo is None else when.astimezone(UTC)


def _wanted(a: argparse.Namespace) -> "Wanted":
    from station.archive.reader import Wanted

    score = 0.05 if a.segment is not None and a.score is None else a.score
    return Wanted(
        serial=a.serial,
        since=a.since,
        until=a.until,
        verdict=a.verdict,
        reason=a.reason,
        segment=a.segment,
        min_score=score,
        newest_first=a.last is not None,
        limit=a.last,
    )


def _list(arguments: argparse.Namespace) -> int:
    from station.archive.reader import find

    rows = find(arguments.folder, _wanted(arguments))
    for row in rows:
        print(_line(row))
    return 0


def _line(row: "Row") -> str:
    late = {True: "", False: "not shown to the PLC", None: "unknown whether the PLC saw it"}[row.shown_to_plc]
    notes = [
        row.reason or "",
        "" if row.purpose == "part" else row.purpose,
        late if row.purpose != "test" else "",
    ]
    notes.append("" if row.frame_state in ("kept", "none") else f"picture {row.frame_state}")
    worst = "     " if row.worst_score is None else f"{row.worst_score:5.3f}"
    said = ", ".join(note for note in notes if note)
    return f"{row.inspection_id:8d}  {row.grabbed_at[:19].replace('T', ' ')}  {row.verdict:5}  {worst}  {row.serial:20}  {said}".rstrip()


def _verify(arguments: argparse.Namespace) -> int:
    from station.archive.reader import find, verify
    from station.journal.journal import entries, verify_journal

    bad = 0
    for name, problem in chain(verify(arguments.folder), verify_journal(arguments.folder)):
        bad += 1
        print(f"weldgate: {arguments.folder}: {name}: {problem}", file=sys.stderr)
    print(
        f"{len(find(arguments.folder))} records, {len(entries(arguments.folder))} entries of the journal, {bad} problems"
    )
    return 1 if bad else 0


def _prune(arguments: argparse.Namespace) -> int:
    from station.archive.prune import prune
    from station.settings.file import load

    keep = load(arguments.settings).archive.keep
    done = prune(arguments.folder, keep, datetime.now(UTC), arguments.dry_run)
    verb = "would go" if arguments.dry_run else "let go"
    print(f"{verb}: {done.frames} pictures, {done.records} records, {done.bytes / 1e6:.1f} MB")
    return 0


def _export(arguments: argparse.Namespace) -> int:
    from station.analysis.export import export
    from station.archive.reader import read_records

    if not arguments.target.resolve().parent.is_dir():
        raise RecordError(f"{arguments.target}: its folder does not exist")
    bad = 0
    for path, problem in export(
        read_records(arguments.folder, _wanted(arguments)),
        arguments.folder,
        arguments.target,
        arguments.format,
    ):
        bad += 1
        print(f"weldgate: {path}: {problem}", file=sys.stderr)
    print(arguments.target)
    return 1 if bad else 0


def _report(arguments: argparse.Namespace) -> int:
    from station.analysis.report.page import report
    from station.analysis.report.pdf import write_pdf
    from station.analysis.truth import read_truth
    from station.archive.reader import read_records

    if not arguments.target.resolve().parent.is_dir() or arguments.target.is_dir():
        raise RecordError(f"{arguments.target}: cannot be written there; name a file in an existing folder")
    entries = sorted(read_records(arguments.folder, _wanted(arguments)), key=lambda e: e.row.inspection_id)
    truth = None if arguments.truth is None else read_truth(arguments.truth)
    page = report(entries, arguments.folder, arguments.title, truth)
    if arguments.target.suffix.lower() == ".pdf":
        write_pdf(page, arguments.target)
    else:
        arguments.target.write_text(page, encoding="utf-8")
    print(arguments.target)
    return 1 if any(entry.problem is not None for entry in entries) else 0


def _bus(arguments: argparse.Namespace) -> int:
    from station.plc.bus_log import read_bus

    for edge in read_bus(arguments.folder):
        print(f"{edge.time}  {edge.by:7}  {edge.name:18} {edge.value!s:>6}  {edge.note}".rstrip())
    return 0

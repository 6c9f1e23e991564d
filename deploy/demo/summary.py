"""Output of the demo: one line per part, a table at the end, and a JSON file."""

import json
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from rich.console import Console
from rich.table import Table

from station.defects import Reason
from station.domain import Verdict
from station.files.durable import write_whole
from station.plc.map.registers import VerdictCode
from station.plc.simulated.line import Answer

REASONS = {reason.code: str(reason) for reason in Reason}
"""Texts of the reasons by PLC code."""


@dataclass(frozen=True, slots=True)
class DemoPart:
    """One frame with known truth."""

    name: str
    path: Path
    truth: str
    """OK, or the name of the defect."""


@dataclass(frozen=True, slots=True)
class Judged:
    """One part with the result that the line received."""

    part: DemoPart
    answer: Answer

    @property
    def verdict(self) -> str:
        """Verdict for the part; OK only if the PLC accepted it by all conditions of its rule."""
        if self.answer.accepted:
            return Verdict.OK
        return Verdict.NOK if self.answer.verdict is VerdictCode.NOK else Verdict.ERROR

    @property
    def escape(self) -> bool:
        """True if a defective part was judged OK."""
        return self.part.truth != "OK" and self.verdict == Verdict.OK

    @property
    def false_reject(self) -> bool:
        """True if a good part was judged NOK."""
        return self.part.truth == "OK" and self.verdict == Verdict.NOK


@dataclass(frozen=True, slots=True, kw_only=True)
class Totals:
    """Counts of parts, errors and handshakes of one run."""

    parts: int
    escapes: int
    false_rejects: int
    errors: int
    handshakes_complete: int

    @property
    def good(self) -> bool:
        """True if every part was judged, its handshake was complete, and there was no escape."""
        return not self.escapes and not self.errors and self.handshakes_complete == self.parts


def count(judged: list[Judged]) -> Totals:
    """Return the totals of a run."""
    return Totals(
        parts=len(judged),
        escapes=sum(part.escape for part in judged),
        false_rejects=sum(part.false_reject for part in judged),
        errors=sum(part.verdict == Verdict.ERROR for part in judged),
        handshakes_complete=sum(part.answer.handshake_complete for part in judged),
    )


def print_part(judged: list[Judged], console: Console) -> None:
    """Print one line for the last part."""
    last = judged[-1]
    style = {"OK": "green", "NOK": "red"}.get(last.verdict, "yellow")
    mark = "[bold red]ESCAPE[/]" if last.escape else "[yellow]false reject[/]" if last.false_reject else ""
    took = "-" if last.answer.trigger_to_valid_ms is None else f"{last.answer.trigger_to_valid_ms:.0f} ms"
    reason = REASONS.get(last.answer.reason, last.answer.refused_by if last.verdict == "ERROR" else "") or ""
    verdict = f"[{style}]{last.verdict:5}[/]"
    console.print(
        f"{len(judged):4d}  {last.part.name:16}  is {last.part.truth:13} judged {verdict} "
        f"{reason:14} {took:>8}  {mark}"
    )


def summarise(judged: list[Judged], records: Path, console: Console) -> None:
    """Print a table with the totals."""
    totals = count(judged)
    taken_ms = (part.answer.trigger_to_valid_ms for part in judged)
    times = sorted(ms for ms in taken_ms if ms is not None)
    wrong = totals.escapes + totals.false_rejects
    table = Table(title="weldgate demo", show_header=False)
    for name, value in (
        ("parts", str(totals.parts)),
        ("right verdicts", str(totals.parts - wrong - totals.errors)),
        ("wrong verdicts", str(wrong)),
        ("  escapes", str(totals.escapes)),
        ("  false rejects", str(totals.false_rejects)),
        ("not judged (ERROR)", str(totals.errors)),
        ("handshakes complete", f"{totals.handshakes_complete} of {totals.parts}"),
        (
            "trigger to RESULT_VALID",
            f"median {median(times):.0f} ms, worst {times[-1]:.0f} ms" if times else "-",
        ),
        ("records", str(records)),
    ):
        table.add_row(name, value)
    console.print(table)


def write_json(path: Path, judged: list[Judged], records: Path) -> None:
    """Write the results as JSON, atomically. Raises OSError."""
    totals = count(judged)
    report: dict[str, Any] = {
        "parts": [
            {
                "part": part.part.name,
                "truth": part.part.truth,
                "verdict": part.verdict,
                "reason": REASONS.get(part.answer.reason),
                "trigger_to_valid_ms": part.answer.trigger_to_valid_ms,
            }
            for part in judged
        ],
        "escapes": totals.escapes,
        "false_rejects": totals.false_rejects,
        "errors": totals.errors,
        "handshakes_complete": totals.handshakes_complete,
        "records": str(records),
    }
    write_whole(path, json.dumps(report, indent=1).encode())

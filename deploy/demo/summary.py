"""What the demo tells: a line for each part, a table at the end, a JSON file."""

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


@dataclass(frozen=True, slots=True)
class DemoPart:
    """One frame with known truth."""

    name: str
    path: Path
    truth: str


@dataclass(frozen=True, slots=True)
class Judged:
    """What the line got for one part."""

    part: DemoPart
    answer: Answer

    @property
    def verdict(self) -> str:
        """OK only if the PLC accepted the part by all points of its rule."""
        if self.answer.accepted:
            return Verdict.OK
        return Verdict.NOK if self.answer.verdict is VerdictCode.NOK else Verdict.ERROR

    @property
    def escape(self) -> bool:
        """A defective part released."""
        return self.part.truth != "OK" and self.verdict == Verdict.OK

    @property
    def false_reject(self) -> bool:
        """A good part refused."""
        return self.part.truth == "OK" and self.verdict == Verdict.NOK


@dataclass(frozen=True, slots=True)
class Totals:
    """Parts counted."""

    parts: int
    escapes: int
    false_rejects: int
    errors: int
    handshakes_complete: int

    @property
    def good(self) -> bool:
        """Every part judged and answered, none escaped."""
        return not self.escapes and not self.errors and self.handshakes_complete == self.parts


def count(judged: list[Judged]) -> Totals:
    """Totals of a run."""
    return Totals(
        len(judged),
        sum(j.escape for j in judged),
        sum(j.false_reject for j in judged),
        sum(j.verdict == Verdict.ERROR for j in judged),
        sum(j.answer.handshake_complete for j in judged),
    )


def tell(judged: list[Judged], console: Console) -> None:
    """One line for the last part."""
    last = judged[-1]
    style = {"OK": "green", "NOK": "red"}.get(last.verdict, "yellow")
    mark = "[bold red]ESCAPE[/]" if last.escape else "[yellow]false reject[/]" if last.false_reject else ""
    took = "-" if last.answer.trigger_to_valid_ms is None else f"{last.answer.trigger_to_valid_ms:.0f} ms"
    reason = REASONS.get(last.answer.reason, last.answer.refused_by if last.verdict == "ERROR" else "") or ""
    console.print(
        f"{len(judged):4d}  {last.part.name:16}  is {last.part.truth:13} judged [{style}]{last.verdict:5}[/] {reason:14} {took:>8}  {mark}"
    )


def summarise(judged: list[Judged], records: Path, console: Console) -> None:
    """Table at the end."""
    totals = count(judged)
    times = sorted(j.answer.trigger_to_valid_ms for j in judged if j.answer.trigger_to_valid_ms is not None)
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
    """The whole report, or nothing."""
    totals = count(judged)
    report: dict[str, Any] = {
        "parts": [
            {
                "part": j.part.name,
                "truth": j.part.truth,
                "verdict": j.verdict,
                "reason": REASONS.get(j.answer.reason),
                "trigger_to_valid_ms": j.answer.trigger_to_valid_ms,
            }
            for j in judged
        ],
        "escapes": totals.escapes,
        "false_rejects": totals.false_rejects,
        "errors": totals.errors,
        "handshakes_complete": totals.handshakes_complete,
        "records": str(records),
    }
    write_whole(path, json.dumps(report, indent=1).encode())

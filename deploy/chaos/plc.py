"""Thousands of parts between the station's line and the simulated PLC while both sides misbehave; proves that no OK is ever wrong.

The pictures are left out: a judge answers by a list of truths, sometimes too late or with an error. Line, wire and PLC block are the
production ones, over Modbus TCP on loopback.
"""

import argparse
import asyncio
import random
import statistics
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from rich.console import Console
from rich.progress import track
from rich.table import Table

from deploy.chaos.judge import Judge, judged
from deploy.demo.ports import free_ports
from station.domain import SEGMENTS
from station.errors import WeldgateError
from station.plc.line import make_line
from station.plc.map.registers import VerdictCode
from station.plc.port import Result, Trigger
from station.plc.simulated.line import Answer, Knob, SimulatedLine
from station.plc.simulated.windows import OwnWindows
from station.settings.model import PlcSettings

MODES = ("server", "client")
WINDOW_S = 1.5
KNOB_SHARE = 0.012
"""Share of the parts in which each knob is turned."""
LATE_SHARE, ERROR_SHARE, OK_SHARE = 0.005, 0.02, 0.6
DEADLINE_MS = 300
SLACK = 1.0
"""All time-outs are so many times as long: on a machine that is busy otherwise a thread may wait for some 100 ms to run."""
SETTLED = 1
"""Parts after a disturbed one that are not yet counted as undisturbed."""


@dataclass(slots=True)
class Report:
    """What happened in one mode."""

    mode: str
    parts: int = 0
    passed: int = 0
    false_ok: int = 0
    """OK for a part that was not judged OK."""
    mismatched: int = 0
    """A result taken for a part that it was not made for, or one that the station does not know of."""
    lost: int = 0
    """An undisturbed part without its verdict."""
    knobs: Counter[str] = field(default_factory=Counter)
    refused_by: Counter[str] = field(default_factory=Counter)
    valid_ms: list[float] = field(default_factory=list)

    @property
    def good(self) -> bool:
        """Whether nothing went wrong that must not."""
        return self.false_ok == self.mismatched == self.lost == 0


class Truths:
    """Decides by chance, and remembers."""

    def __init__(self, seed: int) -> None:
        self._rng = random.Random(seed)
        self.made: dict[int, tuple[str, VerdictCode]] = {}
        """Serial and verdict of each inspection id."""
        self.late: set[str] = set()

    def decide(self, trigger: Trigger) -> Result:
        """Sometimes too late, sometimes an error."""
        late = self._rng.random() < LATE_SHARE
        if late:
            self.late.add(trigger.serial)
        time.sleep(DEADLINE_MS * SLACK / 1000 * 1.3 if late else self._rng.uniform(0.0, 0.01))
        roll = self._rng.random()
        verdict = (
            VerdictCode.ERROR
            if roll < ERROR_SHARE
            else VerdictCode.OK
            if roll < OK_SHARE
            else VerdictCode.NOK
        )
        number = len(self.made) + 1
        self.made[number] = (trigger.serial, verdict)
        reason = 0 if verdict is VerdictCode.OK else 1
        error = 0x1001 if verdict is VerdictCode.ERROR else 0
        result = judged(trigger, verdict, number)
        return replace(result, reason=reason, error_code=error, seg_scores=(100,) * SEGMENTS)


def run(mode: str, parts: int, seed: int, progress: bool = False) -> Report:
    """Pass parts through one mode with failures rolled by the seed. Raises LineError."""
    settings = PlcSettings(
        mode="server" if mode == "server" else "client",
        port=free_ports(1)[0],
        deadline_ms=round(DEADLINE_MS * SLACK),
        result_ttl_ms=round(1000 * WINDOW_S * SLACK),
        stuck_ms=round(300 * SLACK),
        plc_heartbeat_ms=round(500 * SLACK),
        poll_ms=5,
        timeout_ms=round(400 * SLACK),
        writer_idle_ms=round(200 * SLACK),
    )
    line = make_line(settings)
    if mode == "server":
        line.start()
        plc = SimulatedLine.at("127.0.0.1", line.port, accept_simulated=False, seed=seed)
    else:
        plc = SimulatedLine(OwnWindows("127.0.0.1", settings.port), accept_simulated=False, seed=seed)
        line.start()
    try:
        truths = Truths(seed + 1)
        with Judge(line, truths.decide):
            return asyncio.run(_drive(plc, truths, mode, parts, seed, progress))
    finally:
        line.stop()


async def _drive(
    plc: SimulatedLine, truths: Truths, mode: str, parts: int, seed: int, progress: bool
) -> Report:
    rng, report, calm = random.Random(seed), Report(mode), 0
    await plc.connect(10.0)
    try:
        for number in track(range(parts), description=mode, transient=True, disable=not progress):
            knobs = frozenset(knob for knob in Knob if rng.random() < KNOB_SHARE)
            serial = f"P{number:07d}"
            answer = await plc.inspect(serial, WINDOW_S * SLACK, knobs=knobs)
            calm = 0 if knobs or serial in truths.late else calm + 1
            _note(report, answer, serial, knobs, truths, calm > SETTLED)
    finally:
        await plc.close()
    return report


def _note(
    report: Report, answer: Answer, serial: str, knobs: frozenset[Knob], truths: Truths, undisturbed: bool
) -> None:
    report.parts += 1
    report.knobs.update(str(knob) for knob in knobs)
    made = truths.made.get(answer.inspection_id)
    if answer.accepted:
        report.passed += 1
        report.false_ok += made is None or made[1] is not VerdictCode.OK
        report.mismatched += made is None or made[0] != serial
    else:
        report.refused_by[answer.refused_by or ""] += 1
    if undisturbed:
        report.lost += made is None or made[0] != serial or made[1] is not answer.verdict
        if answer.trigger_to_valid_ms is not None:
            report.valid_ms.append(answer.trigger_to_valid_ms)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the report; 0 if no OK was false and nothing was lost or mixed up."""
    parser = argparse.ArgumentParser(prog="chaos-plc", description=__doc__)
    parser.add_argument("--parts", type=int, default=10_000, help="in each mode (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the failures (default: %(default)s)")
    parser.add_argument("--mode", choices=MODES, nargs="+", default=list(MODES))
    arguments = parser.parse_args(argv)
    if arguments.parts < 1:
        parser.error("--parts must be at least 1")
    try:
        reports = [run(mode, arguments.parts, arguments.seed, sys.stderr.isatty()) for mode in arguments.mode]
    except WeldgateError as error:
        print(f"chaos-plc: {error}", file=sys.stderr)
        return 2
    tell(reports, Console(width=110))
    return 0 if all(report.good for report in reports) else 1


def tell(reports: Sequence[Report], console: Console) -> None:
    """The report as a table."""
    table = Table("", *(f"{r.mode} mode" for r in reports), title="PLC and station misbehaving")
    rows: list[tuple[str, list[str]]] = [
        ("parts", [str(r.parts) for r in reports]),
        ("passed", [str(r.passed) for r in reports]),
        ("false OK", [str(r.false_ok) for r in reports]),
        ("results matched to the wrong part", [str(r.mismatched) for r in reports]),
        ("lost results", [str(r.lost) for r in reports]),
        (
            "trigger to RESULT_VALID, median ms",
            [f"{statistics.median(r.valid_ms):.1f}" if r.valid_ms else "-" for r in reports],
        ),
    ]
    rows += [(f"knob: {knob}", [str(r.knobs[str(knob)]) for r in reports]) for knob in Knob]
    why = sorted({name for r in reports for name in r.refused_by})
    rows += [(f"refused: {name}", [str(r.refused_by[name]) for r in reports]) for name in why]
    for name, values in rows:
        table.add_row(name, *values)
    console.print(table)


if __name__ == "__main__":
    sys.exit(main())

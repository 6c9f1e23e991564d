"""Passes thousands of parts while PLC and station both misbehave; proves that no part is falsely released.

There are no images: a judge answers with random verdicts, sometimes too late or with an error. Line, Modbus
code and PLC block are those of production, over Modbus TCP on loopback.
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
from deploy.chaos.stalls import Stalls
from deploy.demo.ports import free_ports
from station.domain import SEGMENTS
from station.errors import WeldgateError
from station.numbers import whole_option
from station.plc.block.timers import TimerKind
from station.plc.line import make_line
from station.plc.map.registers import VerdictCode
from station.plc.port import Result, Trigger
from station.plc.simulated.line import POLL_S, Answer, Fault, SimulatedLine
from station.plc.simulated.windows import OwnWindows, RemoteWindows, Windows
from station.settings.model import PlcSettings

MODES = ("server", "client")
"""Modbus roles of the station."""
WINDOW_S = 1.5
"""Time for which the PLC waits for a result."""
FAULT_FRACTION = 0.012
"""Fraction of the parts with which each fault is injected."""
LATE_FRACTION, ERROR_FRACTION, OK_FRACTION = 0.005, 0.02, 0.6
"""Fractions of late results, of errors, and of errors and OK together."""
DEADLINE_MS = 300
"""Deadline of the station."""
SLACK = 1.0
"""Factor for all time-outs: on a busy machine a thread may wait some 100 ms until it runs."""
STALL_FRACTION = 0.5
"""Part of the deadline for which threads may wait for a processor until a part counts as disturbed."""
SETTLED = 1
"""Number of parts after a disturbed one that still count as disturbed."""


@dataclass(slots=True, kw_only=True)
class Report:
    """Results of one mode."""

    mode: str
    parts: int = 0
    passed: int = 0
    """Number of parts that the PLC accepted."""
    false_ok: int = 0
    """Number of accepted parts that were not judged OK."""
    mismatched: int = 0
    """Number of accepted parts whose result belongs to another part or to none."""
    undisturbed: int = 0
    """Number of parts without a fault, of their own or of the part before."""
    stalled: int = 0
    """Number of parts during which the machine kept the threads waiting."""
    lost: int = 0
    """Number of undisturbed parts that did not get their verdict."""
    faults: Counter[str] = field(default_factory=Counter)
    """Number of injections of each fault."""
    refused_by: Counter[str] = field(default_factory=Counter)
    """Number of parts that were not accepted, by the condition that was not met."""
    valid_ms: list[float] = field(default_factory=list)
    """Times from trigger to RESULT_VALID of undisturbed parts."""

    @property
    def good(self) -> bool:
        """True if no part was falsely released, mixed up or lost; never of a run in which none counts."""
        return self.false_ok == self.mismatched == self.lost == 0 and self.undisturbed > 0


class Truths:
    """Random verdicts, and a record of them."""

    def __init__(self, seed: int) -> None:
        self._rng = random.Random(seed)
        self.made: dict[int, tuple[str, VerdictCode]] = {}
        """Serial and verdict by inspection number."""
        self.late: set[str] = set()
        """Serials of the parts that were answered too late."""

    def decide(self, trigger: Trigger) -> Result:
        """Return a random result, sometimes an error, sometimes too late."""
        late = self._rng.random() < LATE_FRACTION
        if late:
            self.late.add(trigger.serial)
        time.sleep(DEADLINE_MS * SLACK / 1000 * 1.3 if late else self._rng.uniform(0.0, 0.01))
        roll = self._rng.random()
        verdict = (
            VerdictCode.ERROR
            if roll < ERROR_FRACTION
            else VerdictCode.OK
            if roll < OK_FRACTION
            else VerdictCode.NOK
        )
        number = len(self.made) + 1
        self.made[number] = (trigger.serial, verdict)
        reason = 0 if verdict is VerdictCode.OK else 1
        error = 0x1001 if verdict is VerdictCode.ERROR else 0
        result = judged(trigger, verdict, number)
        return replace(result, reason=reason, error_code=error, seg_scores=(100,) * SEGMENTS)


@dataclass(frozen=True, slots=True, kw_only=True)
class Controller:
    """The simulated controller."""

    poll_ms: int | None = None
    """Time between two cycles; None: as fast as it can."""
    timers: TimerKind = TimerKind.CALL


FAST = Controller()
"""Controller without a pause between two cycles, with the timers of the standard."""


def run(mode: str, parts: int, seed: int, controller: Controller = FAST, *, progress: bool = False) -> Report:
    """Pass parts through one mode with random faults, and return the report. Raises LineError."""
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
        windows: Windows = RemoteWindows.at("127.0.0.1", line.port)
    else:
        windows = OwnWindows("127.0.0.1", settings.port)
        line.start()
    poll_s = POLL_S if controller.poll_ms is None else controller.poll_ms / 1000
    plc = SimulatedLine(windows, accept_simulated=False, seed=seed, poll_s=poll_s, timers=controller.timers)
    try:
        truths = Truths(seed + 1)
        with Judge(line, truths.decide):
            return asyncio.run(_drive(plc, truths, mode, parts=parts, seed=seed, progress=progress))
    finally:
        line.stop()


async def _drive(
    plc: SimulatedLine, truths: Truths, mode: str, *, parts: int, seed: int, progress: bool
) -> Report:
    rng, report, stalls, calm = random.Random(seed), Report(mode=mode), Stalls(), 0
    await plc.connect(10.0)
    try:
        for number in track(range(parts), description=mode, transient=True, disable=not progress):
            faults = frozenset(fault for fault in Fault if rng.random() < FAULT_FRACTION)
            serial = f"P{number:07d}"
            answer = await plc.inspect(serial, WINDOW_S * SLACK, faults=faults)
            stalled = stalls.since_last_s() > STALL_FRACTION * DEADLINE_MS * SLACK / 1000
            report.stalled += stalled
            calm = 0 if faults or stalled or serial in truths.late else calm + 1
            _note(report, answer, serial, faults=faults, truths=truths, undisturbed=calm > SETTLED)
    finally:
        await plc.close()
    return report


def _note(
    report: Report,
    answer: Answer,
    serial: str,
    *,
    faults: frozenset[Fault],
    truths: Truths,
    undisturbed: bool,
) -> None:
    report.parts += 1
    report.faults.update(str(fault) for fault in faults)
    made = truths.made.get(answer.inspection_id)
    if answer.accepted:
        report.passed += 1
        report.false_ok += made is None or made[1] is not VerdictCode.OK
        report.mismatched += made is None or made[0] != serial
    else:
        report.refused_by[answer.refused_by or ""] += 1
    if undisturbed:
        report.undisturbed += 1
        report.lost += made is None or made[0] != serial or made[1] is not answer.verdict
        if answer.trigger_to_valid_ms is not None:
            report.valid_ms.append(answer.trigger_to_valid_ms)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the report; return 0 if no part was falsely released, mixed up or lost."""
    parser = argparse.ArgumentParser(
        prog="chaos-plc", description="Pass thousands of parts while PLC and station both misbehave."
    )
    parser.add_argument(
        "--parts",
        type=whole_option,
        default=10_000,
        metavar="N",
        help="number of parts per mode (default: %(default)s)",
    )
    parser.add_argument(
        "--seed",
        type=whole_option,
        default=1,
        metavar="N",
        help="seed of verdicts and faults (default: %(default)s)",
    )
    parser.add_argument(
        "--mode",
        choices=MODES,
        nargs="+",
        default=list(MODES),
        help="Modbus role of the station (default: both)",
    )
    parser.add_argument(
        "--poll-ms",
        type=whole_option,
        metavar="MS",
        help="time between two cycles of the PLC (default: as fast as it can)",
    )
    parser.add_argument(
        "--timers",
        choices=list(TimerKind),
        type=TimerKind,
        default=TimerKind.CALL,
        help="what updates a timer: the call, or each access as on an S7 (default: %(default)s)",
    )
    arguments = parser.parse_args(argv)
    if arguments.parts < 1:
        parser.error("--parts must be at least 1")
    if arguments.poll_ms is not None and not 1 <= arguments.poll_ms <= 100:
        parser.error("--poll-ms must be 1 to 100")
    controller = Controller(poll_ms=arguments.poll_ms, timers=arguments.timers)
    try:
        reports = [
            run(mode, arguments.parts, arguments.seed, controller, progress=sys.stderr.isatty())
            for mode in arguments.mode
        ]
    except WeldgateError as error:
        print(f"chaos-plc: {error}", file=sys.stderr)
        return 2
    print_reports(reports, Console(width=110))
    return 0 if all(report.good for report in reports) else 1


def print_reports(reports: Sequence[Report], console: Console) -> None:
    """Print the reports as a table."""
    table = Table("", *(f"{report.mode} mode" for report in reports), title="PLC and station misbehave")
    rows: list[tuple[str, list[str]]] = [
        ("parts", [str(report.parts) for report in reports]),
        ("passed", [str(report.passed) for report in reports]),
        ("undisturbed", [str(report.undisturbed) for report in reports]),
        ("with the machine too busy", [str(report.stalled) for report in reports]),
        ("false OK", [str(report.false_ok) for report in reports]),
        ("results matched to the wrong part", [str(report.mismatched) for report in reports]),
        ("lost results", [str(report.lost) for report in reports]),
        (
            "trigger to RESULT_VALID, median ms",
            [f"{statistics.median(own.valid_ms):.1f}" if own.valid_ms else "-" for own in reports],
        ),
    ]
    rows += [(f"fault: {fault}", [str(report.faults[str(fault)]) for report in reports]) for fault in Fault]
    conditions = sorted({name for report in reports for name in report.refused_by})
    rows += [
        (f"refused: {name}", [str(report.refused_by[name]) for report in reports]) for name in conditions
    ]
    for name, values in rows:
        table.add_row(name, *values)
    console.print(table)


if __name__ == "__main__":
    sys.exit(main())

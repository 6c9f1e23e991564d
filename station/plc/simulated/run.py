"""Runs a simulated line from the command line: paced parts, faults on request, one printed row each."""

import asyncio
import random
from dataclasses import dataclass

from station.errors import LineError
from station.plc.simulated.line import Answer, Fault, SimulatedLine
from station.plc.simulated.windows import OwnWindows, RemoteWindows, Windows

FAULT_FRACTION = 0.1
"""Fraction of the parts for which a requested fault is injected."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LineRun:
    """Settings of one run."""

    mode: str
    """Mode of the station: server or client."""
    host: str
    port: int
    parts: int
    pace_s: float
    accept_simulated: bool
    faults: tuple[str, ...]
    seed: int


async def run_line(run: LineRun) -> int:
    """Run the line, print a row for each part and return how many passed. Raises LineError."""
    unknown = sorted(set(run.faults) - set(Fault))
    if unknown:
        raise LineError(f"unknown fault: {', '.join(unknown)}. Known faults: {', '.join(Fault)}")
    if run.parts < 1 or run.pace_s < 0:
        raise LineError("--parts must be at least 1 and --pace at least 0")
    windows: Windows = OwnWindows(run.host, run.port)
    if run.mode == "server":
        windows = RemoteWindows.at(run.host, run.port)
    line = SimulatedLine(windows, run.accept_simulated, seed=run.seed)
    rng, passed = random.Random(run.seed), 0
    await line.connect(timeout_s=5)
    try:
        for number in range(1, run.parts + 1):
            faults = frozenset(Fault(name) for name in run.faults if rng.random() < FAULT_FRACTION)
            outcome = await line.inspect(f"LINE-{number:06d}", faults=faults)
            passed += outcome.accepted
            print(_row(number, outcome, faults))
            await line.meanwhile(asyncio.sleep(run.pace_s))
    finally:
        await line.close()
    print(f"{run.parts} parts, {passed} passed")
    return passed


def _row(number: int, outcome: Answer, faults: frozenset[Fault]) -> str:
    took = "-" if outcome.trigger_to_valid_ms is None else f"{outcome.trigger_to_valid_ms:.0f} ms"
    injected = f"  [{', '.join(sorted(faults))}]" if faults else ""
    decision = "pass" if outcome.accepted else "reject"
    why = f"{outcome.refused_by or ''}{injected}"
    return f"{number:4d}  {outcome.verdict.name:5}  {decision}  {took:>8}  {why}".rstrip()

"""A simulated line for people: parts at a pace, failures on demand, one printed row each."""

import asyncio
import random
from dataclasses import dataclass

from station.errors import LineError
from station.plc.simulated.line import Answer, Knob, SimulatedLine
from station.plc.simulated.windows import OwnWindows, RemoteWindows, Windows
from station.plc.wire.modbus import ModbusClient

KNOB_SHARE = 0.1
"""Share of the parts in which a named knob is turned."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LineRun:
    """What is wanted."""

    mode: str
    """Of the station: server or client."""
    host: str
    port: int
    parts: int
    pace_s: float
    accept_simulated: bool
    knobs: tuple[str, ...]
    seed: int


async def run_line(run: LineRun) -> int:
    """Print a row a part; parts that passed. Raises LineError."""
    unknown = sorted(set(run.knobs) - set(Knob))
    if unknown:
        raise LineError(f"no such knob: {', '.join(unknown)}; there are: {', '.join(Knob)}")
    if run.parts < 1 or run.pace_s < 0:
        raise LineError("--parts must be at least 1, --pace at least 0")
    windows: Windows = OwnWindows(run.host, run.port)
    if run.mode == "server":
        windows = RemoteWindows(lambda: ModbusClient(run.host, run.port))
    line, rng, passed = (
        SimulatedLine(windows, run.accept_simulated, seed=run.seed),
        random.Random(run.seed),
        0,
    )
    await line.connect(timeout_s=5)
    try:
        for number in range(1, run.parts + 1):
            knobs = frozenset(Knob(name) for name in run.knobs if rng.random() < KNOB_SHARE)
            answer = await line.inspect(f"LINE-{number:06d}", knobs=knobs)
            passed += answer.accepted
            print(_row(number, answer, knobs))
            await line.meanwhile(asyncio.sleep(run.pace_s))
    finally:
        await line.close()
    print(f"{run.parts} parts, {passed} passed")
    return passed


def _row(number: int, answer: Answer, knobs: frozenset[Knob]) -> str:
    took = "-" if answer.trigger_to_valid_ms is None else f"{answer.trigger_to_valid_ms:.0f} ms"
    turned = f"  [{', '.join(sorted(knobs))}]" if knobs else ""
    outcome = "pass" if answer.accepted else "reject"
    return f"{number:4d}  {answer.verdict.name:5}  {outcome}  {took:>8}  {answer.refused_by or ''}{turned}".rstrip()

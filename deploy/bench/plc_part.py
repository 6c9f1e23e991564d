"""Measures what a part costs the PLC at several poll times, and draws the signals of one part.

The block runs in a simulated controller that reads, is called and writes once per poll; the inspection is a
judge that takes a fixed time. What is drawn are the edges of the station's own bus log.
"""

import argparse
import asyncio
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median

from rich.console import Console
from rich.table import Table

from deploy.bench.signals import LANES, drawn
from deploy.chaos.judge import Judge, judged
from deploy.demo.ports import free_ports
from station.errors import WeldgateError
from station.numbers import whole_option
from station.plc.bus_log import Edge, edges
from station.plc.line import make_line
from station.plc.map.registers import Value, VerdictCode
from station.plc.port import Result, Trigger
from station.plc.simulated.line import SimulatedLine
from station.plc.simulated.windows import OwnWindows
from station.settings.model import PlcSettings

POLLS_MS = (20, 50, 100)
JUDGE_S = 0.17
"""Time of the inspection, that of the station on rendered frames."""
WINDOW_S = 4.0


class Bus:
    """Edges on the bus with their times."""

    def __init__(self) -> None:
        self.seen: list[tuple[float, Edge]] = []
        self._last: tuple[dict[str, Value], dict[str, Value]] | None = None

    def __call__(self, time_s: float, command: dict[str, Value], status: dict[str, Value]) -> None:
        """Take in both windows as they are now."""
        if self._last is not None:
            found = edges(time_s, (self._last[0], command), (self._last[1], status))
            self.seen += [(time_s, edge) for edge in found]
        self._last = command, status


def _judge(trigger: Trigger) -> Result:
    time.sleep(JUDGE_S)
    return judged(trigger, VerdictCode.OK)


def measure(mode: str, poll_ms: int, parts: int, bus: Bus) -> list[float]:
    """Return the times from the call with Start to that with PartDone, in ms. Raises LineError."""
    port = free_ports(1)[0]
    settings = PlcSettings(mode="client" if mode == "client" else "server", port=port, poll_ms=poll_ms)
    line = make_line(settings, bus)
    if mode == "client":
        plc = SimulatedLine(OwnWindows("127.0.0.1", port), accept_simulated=False, poll_s=poll_ms / 1000)
    else:
        plc = SimulatedLine.at("127.0.0.1", port, accept_simulated=False, poll_s=poll_ms / 1000)
    line.start()
    try:
        with Judge(line, _judge):
            return asyncio.run(_drive(plc, parts, bus))
    finally:
        line.stop()


async def _drive(plc: SimulatedLine, parts: int, bus: Bus) -> list[float]:
    times_ms = []
    await plc.connect(10.0)
    try:
        await plc.inspect("FIRST", WINDOW_S)
        for number in range(parts):
            await plc.meanwhile(asyncio.sleep(0.15))
            bus.seen.clear()
            start = time.perf_counter()
            answer = await plc.inspect(f"PART-{number}", WINDOW_S)
            times_ms.append((time.perf_counter() - start) * 1000)
            if not answer.accepted:
                raise WeldgateError(f"the part was refused by: {answer.refused_by}")
    finally:
        await plc.close()
    return times_ms


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print the table, and draw the last part at 20 ms if asked."""
    parser = argparse.ArgumentParser(prog="bench-plc-part", description="Measure what a part costs the PLC.")
    parser.add_argument(
        "--parts", type=whole_option, default=20, metavar="N", help="parts each (default: 20)"
    )
    parser.add_argument("--draw", type=Path, metavar="FILE", help="draw the signals of one part as SVG")
    arguments = parser.parse_args(argv)
    table = Table("station as", "poll ms", "Start to PartDone ms", "slowest ms", "less inspection ms")
    try:
        for mode in ("server", "client"):
            for poll_ms in POLLS_MS:
                bus = Bus()
                took = measure(mode, poll_ms, arguments.parts, bus)
                rest = median(took) - JUDGE_S * 1000
                row = (f"{median(took):.0f}", f"{max(took):.0f}", f"{rest:.0f}")
                table.add_row(mode, str(poll_ms), *row)
                if arguments.draw is not None and (mode, poll_ms) == ("server", POLLS_MS[0]):
                    arguments.draw.write_text(drawn(bus.seen, LANES, f"poll {poll_ms} ms"))
    except WeldgateError as error:
        print(f"bench-plc-part: {error}", file=sys.stderr)
        return 2
    Console(width=110).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())

"""The window killed, restarted and stopped while parts pass: no part may be missed, and the cycle must not care.

Blocks of parts in turns, without a window, with one that is killed in the middle, with one that hangs (SIGSTOP), so that all three see
the same machine.
"""

import argparse
import asyncio
import os
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from deploy.demo.ports import free_ports
from deploy.demo.station import running, shipped_parts, station_toml
from station.archive.reader import find
from station.files.image import read_image
from station.plc.map.registers import VerdictCode
from station.plc.simulated.line import SimulatedLine
from synth.camera.feed import Feed

WAYS = ("no window", "killed and restarted", "hanging")
START_S = 3.0
"""Until a window has opened."""


@dataclass(slots=True)
class Report:
    """What happened to the parts of one way."""

    parts: int = 0
    missed: int = 0
    """Without an OK or NOK inside the PLC's window."""
    valid_ms: list[float] = field(default_factory=list)

    @property
    def p99_ms(self) -> float:
        """Of trigger to RESULT_VALID."""
        return float(np.percentile(self.valid_ms, 99))


def run(folder: Path, blocks: int, parts: int) -> dict[str, Report]:
    """`parts` in each block, `blocks` of each way. Raises WeldgateError."""
    feed, ports = Feed(folder / "feed"), free_ports(4)
    settings = folder / "station.toml"
    settings.write_text(station_toml(folder / "records", *ports))
    command = [sys.executable, "-m", "station", "engine", "-c", str(settings)]
    with (folder / "engine.log").open("w") as log, running(command, {**os.environ, **feed.environment}, log):
        return asyncio.run(_drive(feed, ports[0], settings, blocks, parts))


async def _drive(feed: Feed, port: int, settings: Path, blocks: int, parts: int) -> dict[str, Report]:
    line, reports = (
        SimulatedLine.at("127.0.0.1", port, accept_simulated=True),
        {way: Report() for way in WAYS},
    )
    images = [read_image(part.path) for part in shipped_parts()]
    await line.connect()
    await line.wait_ready(30.0)
    try:
        for block in range(blocks):
            for way in WAYS:
                window = None if way == "no window" else _open(settings)
                await line.meanwhile(asyncio.sleep(START_S))  # in each way, so that all are alike
                if window is not None and way == "hanging":
                    window.send_signal(signal.SIGSTOP)
                for number in range(parts):
                    if window is not None and number == parts // 2 and way != "hanging":
                        window.kill()
                        window.wait()
                        window = _open(settings)
                    feed.show(images[number % len(images)])
                    answer = await line.inspect(f"{block}-{WAYS.index(way)}-{number}")
                    report = reports[way]
                    report.parts += 1
                    report.missed += answer.verdict not in (VerdictCode.OK, VerdictCode.NOK)
                    if answer.trigger_to_valid_ms is not None:
                        report.valid_ms.append(answer.trigger_to_valid_ms)
                if window is not None:
                    window.kill()
                    window.wait()
    finally:
        await line.close()
    return reports


def _open(settings: Path) -> "subprocess.Popen[bytes]":
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    command = [sys.executable, "-m", "station", "panel", "-c", str(settings)]
    return subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def main(argv: Sequence[str] | None = None) -> int:
    """Print the report; 0 if no part was missed and every part has its record."""
    parser = argparse.ArgumentParser(prog="chaos-panel", description=__doc__)
    parser.add_argument("--blocks", type=int, default=10, help="of each way (default: %(default)s)")
    parser.add_argument("--parts", type=int, default=20, help="in each block (default: %(default)s)")
    arguments = parser.parse_args(argv)
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="weldgate-") as name:
        reports = run(Path(name), arguments.blocks, arguments.parts)
        records = len(find(Path(name) / "records"))
    table = Table("", *WAYS, title=f"{arguments.blocks} blocks of {arguments.parts} parts each, in turns")
    plain = reports[WAYS[0]]
    rows = [
        ("parts", [str(r.parts) for r in reports.values()]),
        ("missed", [str(r.missed) for r in reports.values()]),
        (
            "trigger to RESULT_VALID, median ms",
            [f"{statistics.median(r.valid_ms):.0f}" for r in reports.values()],
        ),
        ("p99 ms", [f"{r.p99_ms:.0f}" for r in reports.values()]),
        ("p99 beside no window", [f"{r.p99_ms / plain.p99_ms:.2f}" for r in reports.values()]),
    ]
    for name, values in rows:
        table.add_row(name, *values)
    console = Console(width=110)
    console.print(table)
    total = sum(r.parts for r in reports.values())
    console.print(f"{records} records of {total} parts, {time.monotonic() - start:.0f} s")
    return 0 if records == total and not any(r.missed for r in reports.values()) else 1


if __name__ == "__main__":
    sys.exit(main())

"""Kills, restarts and suspends the window while parts pass; no part may be missed, and none may take longer.

Blocks of parts alternate between three ways, so that all have the same conditions: without a window, with a
window that is killed and restarted halfway, and with a window that hangs (SIGSTOP).
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
from station.numbers import whole_option
from station.plc.map.registers import VerdictCode
from station.plc.simulated.line import SimulatedLine
from synth.camera.feed import Feed

WAYS = ("no window", "killed and restarted", "hanging")
"""Ways in which the window is treated."""
START_S = 3.0
"""Time in which a window opens."""


@dataclass(slots=True, kw_only=True)
class Report:
    """Results of the parts of one way."""

    parts: int = 0
    missed: int = 0
    """Number of parts without OK or NOK in time."""
    valid_ms: list[float] = field(default_factory=list)
    """Times from trigger to RESULT_VALID."""

    @property
    def p99_ms(self) -> float:
        """99th percentile of the times from trigger to RESULT_VALID."""
        return float(np.percentile(self.valid_ms, 99))


def run(folder: Path, blocks: int, parts: int, *, deadline_ms: int = 2000) -> dict[str, Report]:
    """Return the reports of `blocks` blocks of each way with `parts` parts each. Raises WeldgateError."""
    feed, port = Feed(folder / "feed"), free_ports(1)[0]
    settings = folder / "station.toml"
    settings.write_text(station_toml(folder / "records", port, deadline_ms=deadline_ms))
    command = [sys.executable, "-m", "station", "engine", "-c", str(settings)]
    with (folder / "engine.log").open("w") as log, running(command, {**os.environ, **feed.environment}, log):
        window_s = deadline_ms / 1000 + 2
        return asyncio.run(_drive(feed, port, settings, blocks=blocks, parts=parts, window_s=window_s))


async def _drive(
    feed: Feed, port: int, settings: Path, *, blocks: int, parts: int, window_s: float
) -> dict[str, Report]:
    line = SimulatedLine.at("127.0.0.1", port, accept_simulated=True)
    reports = {way: Report() for way in WAYS}
    images = [read_image(part.path) for part in shipped_parts()]
    await line.connect()
    await line.wait_ready(30.0)
    try:
        for block in range(blocks):
            for way in WAYS:
                window = None if way == "no window" else _open(settings)
                await line.meanwhile(asyncio.sleep(START_S))  # for every way, so that all are treated alike
                if window is not None and way == "hanging":
                    window.send_signal(signal.SIGSTOP)
                for number in range(parts):
                    if window is not None and number == parts // 2 and way != "hanging":
                        window.kill()
                        window.wait()
                        window = _open(settings)
                    feed.show(images[number % len(images)])
                    answer = await line.inspect(f"{block}-{WAYS.index(way)}-{number}", window_s)
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
    """Print the report; return 0 if no part was missed and every part has a record."""
    parser = argparse.ArgumentParser(
        prog="chaos-panel", description="Kill, restart and suspend the window while parts pass."
    )
    parser.add_argument(
        "--blocks",
        type=whole_option,
        default=10,
        metavar="N",
        help="number of blocks per way (default: %(default)s)",
    )
    parser.add_argument(
        "--parts",
        type=whole_option,
        default=20,
        metavar="N",
        help="number of parts per block (default: %(default)s)",
    )
    arguments = parser.parse_args(argv)
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="weldgate-") as name:
        reports = run(Path(name), arguments.blocks, arguments.parts)
        records = len(find(Path(name) / "records"))
    table = Table("", *WAYS, title=f"{arguments.blocks} alternating blocks of {arguments.parts} parts each")
    plain, results = reports[WAYS[0]], list(reports.values())
    rows = [
        ("parts", [str(report.parts) for report in results]),
        ("missed", [str(report.missed) for report in results]),
        (
            "trigger to RESULT_VALID, median ms",
            [f"{statistics.median(report.valid_ms):.0f}" for report in results],
        ),
        ("p99 ms", [f"{report.p99_ms:.0f}" for report in results]),
        ("p99 relative to no window", [f"{report.p99_ms / plain.p99_ms:.2f}" for report in results]),
    ]
    for name, values in rows:
        table.add_row(name, *values)
    console = Console(width=110)
    console.print(table)
    total = sum(report.parts for report in results)
    console.print(f"{records} records of {total} parts, {time.monotonic() - start:.0f} s")
    return 0 if records == total and not any(report.missed for report in results) else 1


if __name__ == "__main__":
    sys.exit(main())

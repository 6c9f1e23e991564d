"""Measures what the PLC side adds to a cycle, alone and with four more clients that read.

A judge that answers at once replaces the inspection.
"""

import argparse
import asyncio
import sys
import threading
import time
from collections.abc import Sequence

import numpy as np
from rich.console import Console
from rich.table import Table

from deploy.chaos.judge import Judge, judged
from deploy.demo.ports import free_ports
from station.errors import WeldgateError
from station.numbers import whole_option
from station.plc.line import make_line
from station.plc.map.registers import STATUS_START, STATUS_WORDS, Control, Status, VerdictCode
from station.plc.port import Result, Trigger
from station.plc.wire.modbus import ModbusClient
from station.settings.model import PlcSettings

READERS, READS_PER_S = 4, 50
"""Number of additional clients, and reads per second of each."""
BLOCK = 50
"""Number of parts before the measurement changes between quiet and loaded."""


def _ok(trigger: Trigger) -> Result:
    return judged(trigger, VerdictCode.OK)


async def _until(client: ModbusClient, bit: Status, value: bool) -> None:
    until = time.monotonic() + 5
    while bool((await client.read(STATUS_START, STATUS_WORDS))[0] & bit) != value:
        if time.monotonic() > until:
            raise WeldgateError(f"the station did not answer with {bit.name}")


async def _part(client: ModbusClient, number: int) -> float:
    """Return the milliseconds from writing TRIGGER to reading RESULT_VALID, polled without a pause."""
    await _until(client, Status.READY, True)
    await client.write(2, [number])
    start = time.perf_counter()
    await client.write(0, [int(Control.ENABLE | Control.TRIGGER)])
    await _until(client, Status.RESULT_VALID, True)
    took = (time.perf_counter() - start) * 1000
    await client.write(0, [int(Control.ENABLE | Control.RESULT_ACK)])
    await _until(client, Status.RESULT_VALID, False)
    await client.write(0, [int(Control.ENABLE)])
    return took


def _read_on(port: int, on: threading.Event, stop: threading.Event) -> None:
    async def run() -> None:
        client = ModbusClient("127.0.0.1", port)
        await client.connect()
        while not stop.is_set():
            if on.is_set():
                await client.read(STATUS_START, STATUS_WORDS)
            await asyncio.sleep(1 / READS_PER_S)
        client.close()

    asyncio.run(run())


async def _drive(port: int, parts: int, loaded: threading.Event) -> dict[bool, list[float]]:
    client = ModbusClient("127.0.0.1", port)
    times_ms: dict[bool, list[float]] = {False: [], True: []}
    await client.connect()
    await client.write(0, [int(Control.ENABLE)])
    for number in range(1, 2 * parts + 1):
        load = (number - 1) // BLOCK % 2 == 1
        if load != loaded.is_set():
            (loaded.set if load else loaded.clear)()
            await asyncio.sleep(0.1)
        times_ms[load].append(await _part(client, number))
    client.close()
    return times_ms


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, and print medians and p99."""
    parser = argparse.ArgumentParser(
        prog="bench-plc", description="Measure what the PLC side adds to a cycle."
    )
    parser.add_argument(
        "--parts",
        type=whole_option,
        default=500,
        metavar="N",
        help="number of parts, each without and with more clients (default: %(default)s)",
    )
    arguments = parser.parse_args(argv)
    line = make_line(PlcSettings(port=free_ports(1)[0], plc_heartbeat_ms=0))
    loaded, stop = threading.Event(), threading.Event()
    readers: list[threading.Thread] = []
    try:
        line.start()
        readers = [threading.Thread(target=_read_on, args=(line.port, loaded, stop)) for _ in range(READERS)]
        for reader in readers:
            reader.start()
        with Judge(line, _ok):
            found = asyncio.run(_drive(line.port, arguments.parts, loaded))
    except WeldgateError as error:
        print(f"bench-plc: {error}", file=sys.stderr)
        return 2
    finally:
        stop.set()
        for reader in readers:
            reader.join(timeout=5)
        line.stop()
    table = Table(
        "", "median ms", "p99 ms", title=f"{arguments.parts} parts each, station as server, no inspection"
    )
    others = f"{READERS} more clients, {READS_PER_S} reads/s each"
    rows = (
        ("TRIGGER written to RESULT_VALID read", found[False]),
        (f"the same, {others}", found[True]),
    )
    for name, values in rows:
        table.add_row(name, f"{np.median(values):.2f}", f"{np.percentile(values, 99):.2f}")
    Console(width=110).print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main())

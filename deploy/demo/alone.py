"""`weldgate-demo --station`: a station to try a PLC against, with a new picture at each trigger.

It has no line of its own. It watches its own status window as one more reader, so that the next part lies
there as soon as the picture of the one before is taken.
"""

import asyncio
import itertools
import time
from collections.abc import Iterator

from rich.console import Console

from deploy.demo.hints import server_hints
from deploy.demo.stage import Stage, last_line
from deploy.demo.station import shipped_parts
from deploy.demo.summary import DemoPart
from station.errors import LineError, WeldgateError
from station.plc.map.registers import (
    BY_NAME,
    STATUS_START,
    STATUS_WORDS,
    Status,
    named_bits,
    number,
    unpack,
    unpack_window,
)
from station.plc.wire.modbus import ModbusClient

POLL_S = 0.01
COUNTERS = {"COUNT_OK": "OK", "COUNT_NOK": "NOK", "COUNT_ERROR": "ERROR"}
"""Registers that count verdicts, and the verdicts."""
SERIAL = BY_NAME["PART_SERIAL"]
START_S = 45.0
"""Time within which the station must be up."""


async def stand_alone(stage: Stage, host: str, port: int, console: Console) -> None:
    """Show a new part at each trigger until cancelled. Raises WeldgateError if the engine stops."""
    parts = itertools.cycle(shipped_parts())
    part = next(parts)
    stage.show(part)
    client = ModbusClient("127.0.0.1" if host in ("0.0.0.0", "::") else host, port)
    try:
        await _connect(client, stage)
        console.print(server_hints(host, port), highlight=False, soft_wrap=True)
        await _watch(client, stage, part, parts=parts, console=console)
    finally:
        client.close()


async def _connect(client: ModbusClient, stage: Stage) -> None:
    until = time.monotonic() + START_S
    while True:
        try:
            await client.connect()
            return
        except LineError:
            stage.check()
            if time.monotonic() > until:
                raise WeldgateError(f"the engine did not start: {last_line(stage.log)}") from None
            await asyncio.sleep(0.2)


async def _watch(
    client: ModbusClient, stage: Stage, part: DemoPart, *, parts: Iterator[DemoPart], console: Console
) -> None:
    """Show the next part as soon as a trigger's picture is taken, and print each result.

    The counters tell a verdict even if the PLC has acknowledged it between two reads.
    """
    taken, in_work = -1, part
    counted: tuple[int, ...] = ()
    while True:
        stage.check()
        try:
            values = unpack_window(STATUS_START, await client.read(STATUS_START, STATUS_WORDS))
            serial = unpack(SERIAL, await client.read(SERIAL.address, SERIAL.words))
        except LineError:
            await _connect(client, stage)
            continue
        status, trigger = named_bits(Status, number(values, "STATUS")), number(values, "ACK_TRIGGER_ID")
        counts = tuple(number(values, name) for name in COUNTERS)
        if taken < 0:
            taken, counted = trigger, counts
        over = status & (Status.EXPOSURE_DONE | Status.RESULT_VALID) or not status & Status.BUSY
        if trigger != taken and over:
            taken, in_work, part = trigger, part, next(parts)
            stage.show(part)
        for verdict, before, now in zip(COUNTERS.values(), counted, counts, strict=True):
            if now > before:
                row = f"trigger {taken:5d}  {verdict:5}  truth {in_work.truth:12}  serial {serial}"
                console.print(row.rstrip(), highlight=False)
        counted = counts
        await asyncio.sleep(POLL_S)

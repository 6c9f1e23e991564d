"""A line PLC that runs the handshake and the nine-point acceptance rule against any station, over Modbus TCP."""

import asyncio
import time
from collections.abc import Awaitable
from dataclasses import dataclass
from typing import TypeVar

from station.errors import LineError
from station.plc.modbus import ModbusClient
from station.plc.registers import (
    BY_NAME,
    STATUS_START,
    Control,
    Flags,
    Status,
    Value,
    VerdictCode,
    number,
    pack,
    unpack_window,
)

Outcome = TypeVar("Outcome")

POLL_S = 0.004
HEARTBEAT_S = 0.1


@dataclass(frozen=True, slots=True)
class Answer:
    """What the PLC made of one part."""

    accepted: bool
    """The part flag is OK: all nine points held in one read."""
    verdict: VerdictCode
    refused_by: str | None
    """The first point of the rule that did not hold."""
    trigger_to_valid_ms: float | None
    """None if no result came within the window."""
    inspection_id: int
    reason: int
    handshake_complete: bool
    """Trigger acknowledged, result read and acknowledged, and RESULT_VALID seen to fall."""
    flags: Flags


def refusal(
    values: dict[str, Value], trigger_id: int, serial: str, heartbeat_fresh: bool, config_crc: int, accept_simulated: bool
) -> str | None:
    """The acceptance rule: the first point that does not hold for one read of the status window, or None."""
    status = Status(number(values, "STATUS"))
    points = (
        ("heartbeat stands still", heartbeat_fresh),
        ("RESULT_VALID is 0", Status.RESULT_VALID in status),
        ("OK and NOK are not 1 and 0", Status.OK in status and Status.NOK not in status),
        ("VERDICT is not OK with its complement", (number(values, "VERDICT"), number(values, "VERDICT_INV")) == (1, 0xFFFE)),
        ("SEQ_HEAD differs from SEQ_TAIL", values["SEQ_HEAD"] == values["SEQ_TAIL"]),
        ("result of another trigger or serial", values["RESULT_TRIGGER_ID"] == trigger_id and values["SERIAL_ECHO"] == serial),
        ("configuration is not the released one", number(values, "CONFIG_CRC") == config_crc),
        ("result too old", number(values, "RESULT_AGE_10MS") <= 500),
        ("station reports failure or function check", not status & (Status.FAILURE | Status.FUNCTION_CHECK)),
        ("picture of an emulated camera", accept_simulated or not number(values, "FLAGS") & Flags.SIMULATED),
    )
    return next((name for name, held in points if not held), None)


class SimulatedLine:
    """Drives one station part by part. `accept_simulated`: the demo line takes verdicts of an emulated camera."""

    def __init__(self, host: str, port: int, accept_simulated: bool) -> None:
        self._client = ModbusClient(host, port)
        self._accept_simulated = accept_simulated
        self._control = Control.ENABLE
        self._beat = 0
        self._beat_s = 0.0
        self._seen_beat = -1
        self._seen_s = -1e9
        self._trigger_id = 0
        self._crc: int | None = None
        self._connected = False

    async def connect(self, timeout_s: float = 30.0) -> None:
        """Connect, waiting for a station that is still starting. Raises LineError."""
        until = time.monotonic() + timeout_s
        while True:
            try:
                await self._client.connect()
                break
            except LineError:
                if time.monotonic() > until:
                    raise
                await asyncio.sleep(0.2)
        self._connected = True
        self._trigger_id = number(await self._read(), "ACK_TRIGGER_ID")

    def close(self) -> None:
        """Drop the connection."""
        self._client.close()

    async def meanwhile(self, work: Awaitable[Outcome]) -> Outcome:
        """Keep the heartbeat going until `work` is done."""
        task = asyncio.ensure_future(work)
        while not task.done():
            if self._connected:
                await self._read()
            await asyncio.wait((task,), timeout=HEARTBEAT_S / 2)
        return task.result()

    async def wait_ready(self, timeout_s: float) -> bool:
        """Hold ENABLE and the heartbeat until READY; False after the time."""
        return await self._wait(Status.READY, True, timeout_s) is not None

    async def inspect(self, serial: str, window_s: float = 4.0) -> Answer:
        """One part: trigger, wait for the result inside the window, apply the rule, acknowledge."""
        if not await self.wait_ready(window_s):
            return Answer(False, VerdictCode.NONE, "station not READY", None, 0, 0, False, Flags(0))
        if self._crc is None:
            self._crc = number(await self._read(), "CONFIG_CRC")
        self._trigger_id = self._trigger_id % 0xFFFF + 1
        await self._client.write_command(BY_NAME["PART_SERIAL"].address, pack(BY_NAME["PART_SERIAL"], serial))
        await self._client.write_command(BY_NAME["TRIGGER_ID"].address, [self._trigger_id])
        start = time.monotonic()
        await self._set(self._control | Control.TRIGGER)
        acked = await self._wait(Status.TRIGGER_ACK, True, 1.0)
        await self._set(self._control & ~Control.TRIGGER)
        values = await self._wait(Status.RESULT_VALID, True, window_s) if acked is not None else None
        if values is None:
            return Answer(False, VerdictCode.NONE, "no result inside the window", None, 0, 0, False, Flags(0))
        took_ms = (time.monotonic() - start) * 1000
        fresh = time.monotonic() - self._seen_s < 0.5
        refused = refusal(values, self._trigger_id, serial, fresh, self._crc, self._accept_simulated)
        await self._set(self._control | Control.RESULT_ACK)
        gone = await self._wait(Status.RESULT_VALID, False, 1.0)
        await self._set(self._control & ~Control.RESULT_ACK)
        return Answer(
            refused is None,
            VerdictCode(number(values, "VERDICT")),
            refused,
            took_ms,
            number(values, "INSPECTION_ID"),
            number(values, "REASON"),
            gone is not None,
            Flags(number(values, "FLAGS")),
        )

    async def _set(self, control: Control) -> None:
        self._control = control
        await self._client.write_command(BY_NAME["CONTROL"].address, [int(control), self._beat])

    async def _read(self) -> dict[str, Value]:
        values = unpack_window(STATUS_START, await self._client.read_status())
        now = time.monotonic()
        if values["HEARTBEAT"] != self._seen_beat:
            self._seen_beat, self._seen_s = number(values, "HEARTBEAT"), now
        if now - self._beat_s >= HEARTBEAT_S:
            self._beat, self._beat_s = (self._beat + 1) & 0xFFFF, now
            await self._set(self._control)
        return values

    async def _wait(self, bit: Status, wanted: bool, timeout_s: float) -> dict[str, Value] | None:
        until = time.monotonic() + timeout_s
        while time.monotonic() < until:
            values = await self._read()
            if bool(number(values, "STATUS") & bit) == wanted:
                return values
            await asyncio.sleep(POLL_S)
        return None

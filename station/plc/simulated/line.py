"""A simulated PLC that runs the generated function block against a station, with faults on request.

It uses Modbus TCP and is the client or the server of the station.
"""

import asyncio
import random
import time
from collections.abc import Awaitable, Callable
from typing import TypeVar

from station.errors import LineError
from station.plc.block.definition import NO_RESULT, NOT_READY, REFUSALS
from station.plc.block.timers import TimerKind
from station.plc.block.transcribe import Block
from station.plc.map.registers import (
    BY_NAME,
    COMMAND_START,
    COMMAND_WORDS,
    STATUS_START,
    STATUS_WORDS,
    CommandCode,
    Control,
    Flags,
    Status,
    Value,
    VerdictCode,
    named_bits,
    number,
    pack,
    unpack_window,
)
from station.plc.simulated.answer import Answer as Answer
from station.plc.simulated.answer import Fault as Fault
from station.plc.simulated.windows import RemoteWindows, Windows

Outcome = TypeVar("Outcome")

POLL_S = 0.004
"""Time between two cycles of the PLC."""
UNSEEN_CYCLES = 5
"""Cycles after which a program gives up on a Start that the block has not seen rise."""
UNSEEN = "the block saw no edge of Start"
"""What a part is refused by that was never begun."""
SILENCE_S = (0.05, 0.8)
"""Shortest and longest time for which a faulty PLC does nothing."""


class SimulatedLine:
    """A simulated PLC that drives one station part by part."""

    def __init__(
        self,
        windows: Windows,
        accept_simulated: bool,
        *,
        recipe: int = 1,
        seed: int = 0,
        poll_s: float = POLL_S,
        timers: TimerKind = TimerKind.CALL,
    ) -> None:
        """`accept_simulated`: let parts pass on verdicts of an emulated camera; `recipe`: expected recipe.

        `poll_s`: time between two cycles; `timers`: how the controller's timers work.
        """
        self._windows = windows
        self._block = Block(timers)
        self._poll_s = poll_s
        self._plc = self._block.v  # variables of the block
        self._plc.AcceptSimulated, self._plc.Recipe = accept_simulated, recipe
        self._rng = random.Random(seed)
        self._connected = False
        self._crc_known = False
        self._written: list[int] | None = None
        self._faults: frozenset[Fault] = frozenset()

    @staticmethod
    def at(
        host: str,
        port: int,
        accept_simulated: bool,
        *,
        seed: int = 0,
        poll_s: float = POLL_S,
        timers: TimerKind = TimerKind.CALL,
    ) -> "SimulatedLine":
        """Return a line whose PLC is the client of the station at an address."""
        windows = RemoteWindows.at(host, port)
        return SimulatedLine(windows, accept_simulated, seed=seed, poll_s=poll_s, timers=timers)

    async def connect(self, timeout_s: float = 30.0) -> None:
        """Connect; wait for a station that is still starting. Raises LineError."""
        until = time.monotonic() + timeout_s
        while True:
            try:
                await self._windows.connect()
                break
            except LineError:
                if time.monotonic() > until:
                    raise
                await asyncio.sleep(0.2)
        self._connected = True

    async def close(self) -> None:
        """Close the connection."""
        await self._windows.close()

    async def meanwhile(self, work: Awaitable[Outcome]) -> Outcome:
        """Keep the heartbeat running until `work` is done and return its result."""
        task = asyncio.ensure_future(work)
        while not task.done():
            if self._connected:
                await self._cycle()
            await asyncio.wait((task,), timeout=0.02)
        return task.result()

    async def wait_ready(self, timeout_s: float) -> bool:
        """Hold ENABLE and the heartbeat until READY is 1; return False if it was not in time."""
        return await self._until(
            lambda: bool(self._plc.Window[0] & Status.READY) and number(self.status(), "MAP_VERSION") > 0,
            timeout_s,
        )

    async def command(self, code: CommandCode | int, arg: int = 0, timeout_s: float = 30.0) -> int | None:
        """Have a command carried out and return CMD_ECHO; None if none came."""
        self._plc.CommandCode, self._plc.Argument, self._plc.Extra = int(code), arg, int(Control.EXEC_COMMAND)
        done = await self._until(lambda: bool(self._plc.Window[0] & Status.CMD_DONE), timeout_s)
        echo = number(self.status(), "CMD_ECHO") if done else None
        self._plc.Extra = 0
        await self._until(lambda: not self._plc.Window[0] & Status.CMD_DONE, 2.0)
        return echo

    def status(self) -> dict[str, Value]:
        """Return the status window as last read."""
        return unpack_window(STATUS_START, self._plc.Window)

    async def inspect(
        self, serial: str, window_s: float = 4.0, golden: bool = False, faults: frozenset[Fault] = frozenset()
    ) -> Answer:
        """Run the handshake for one part: trigger, wait for the result, apply the rule, acknowledge.

        `window_s`: time within which the result must come; `golden`: the part is a master.
        """
        plc = self._plc
        plc.Serial, plc.Golden, plc.WindowTime = pack(BY_NAME["PART_SERIAL"], serial), golden, window_s
        if not self._crc_known and await self.wait_ready(window_s):
            plc.Crc, self._crc_known = number(self.status(), "CONFIG_CRC"), True
        self._faults = faults
        plc.Start, quiet, loud = True, Fault.SILENCE not in faults, Fault.BURST in faults
        seen: dict[str, Value] | None = None
        triggered_s: float | None = None
        valid_s: float | None = None
        silent_in = self._rng.choice((10, 30, 40, 50))
        until = time.monotonic() + 2 * window_s
        cycles = 0
        while time.monotonic() < until:
            await self._cycle()
            cycles += 1
            plc.Start = self._start_after(cycles, faults)
            if plc.State == 30 and triggered_s is None:
                triggered_s = time.monotonic()
            if plc.State == 50 and valid_s is None:
                valid_s, seen = time.monotonic(), self.status()
                if Fault.STORM in faults:
                    await self._storm()
            if loud and plc.State == silent_in:
                loud = False
                await self._burst()
            if not quiet and plc.State == silent_in:
                quiet = True
                await asyncio.sleep(self._rng.uniform(*SILENCE_S))
            if plc.PartDone or (cycles >= UNSEEN_CYCLES and not plc.Busy):
                break
            await asyncio.sleep(self._poll_s)
        if not plc.PartDone:
            plc.Start = False
        self._faults = frozenset()
        return self._answer(
            seen, None if triggered_s is None or valid_s is None else (valid_s - triggered_s) * 1000
        )

    def _start_after(self, cycles: int, faults: frozenset[Fault]) -> bool:
        """Return Start for the next cycle; without rest it is still held when the next part comes."""
        if Fault.START_AGAIN in faults and self._plc.State >= 30:
            return cycles % 2 == 0
        return Fault.NO_REST in faults

    def _answer(self, seen: dict[str, Value] | None, took_ms: float | None) -> Answer:
        plc = self._plc
        refused = (REFUSALS[plc.Refusal] or None) if plc.PartDone else UNSEEN
        values = seen or {"VERDICT": 0, "INSPECTION_ID": 0, "REASON": 0, "FLAGS": 0}
        code = number(values, "VERDICT")
        answered = plc.PartDone and seen is not None and plc.Refusal not in (NOT_READY, NO_RESULT)
        return Answer(
            accepted=plc.PartDone and plc.PartOk,
            verdict=VerdictCode(code) if code in list(VerdictCode) else VerdictCode.NONE,
            refused_by=refused,
            trigger_to_valid_ms=took_ms,
            inspection_id=number(values, "INSPECTION_ID"),
            reason=number(values, "REASON"),
            handshake_complete=answered and not plc.Window[0] & Status.RESULT_VALID,
            flags=named_bits(Flags, number(values, "FLAGS")),
            trigger_id=plc.TriggerId,
        )

    async def _until(self, condition: Callable[[], bool], timeout_s: float) -> bool:
        until = time.monotonic() + timeout_s
        while time.monotonic() < until:
            await self._cycle()
            if self._plc.Fresh and condition():
                return True
            await asyncio.sleep(self._poll_s)
        return False

    async def _storm(self) -> None:
        try:
            await self._windows.storm()
        except LineError:
            self._connected = False

    async def _burst(self) -> None:
        try:
            await self._windows.burst()
        except LineError:
            self._connected = False

    async def _cycle(self) -> None:
        """Run one cycle of the PLC: read, run the block, write what changed."""
        plc = self._plc
        plc.PlcTime = int(time.time())
        try:
            if not self._connected:
                await self._windows.connect()
                self._connected, self._written = True, None
            plc.Window, plc.Fresh = await self._read(), True
        except LineError:
            plc.Fresh, self._connected = False, False
        self._block.cycle(time.monotonic())
        words = list(plc.Command)
        try:
            if self._connected and words != self._written:
                await self._write(words)
                self._written = words
        except LineError:
            self._connected = False

    async def _read(self) -> list[int]:
        if Fault.TORN_READS in self._faults:
            words = []
            for address in range(STATUS_START, STATUS_START + STATUS_WORDS):
                words += await self._windows.read(address, 1)
                await asyncio.sleep(0)
            return words
        words = await self._windows.read(STATUS_START, STATUS_WORDS)
        if Fault.WORD_ORDER in self._faults:
            return [(word >> 8) | (word & 0xFF) << 8 for word in words]
        return words

    async def _write(self, words: list[int]) -> None:
        before = self._written
        if (
            Fault.STUCK_ACK in self._faults
            and before is not None
            and before[0] & Control.RESULT_ACK
            and not words[0] & Control.RESULT_ACK
        ):
            await asyncio.sleep(self._rng.uniform(*SILENCE_S))
        if Fault.ID_REUSE in self._faults:
            words = [*words[:2], number(self.status(), "ACK_TRIGGER_ID"), *words[3:]]
        await self._windows.write(COMMAND_START, words[:COMMAND_WORDS])
        if Fault.EARLY_DROP in self._faults and words[0] & Control.TRIGGER:
            await self._windows.write(COMMAND_START, [words[0] & ~Control.TRIGGER])

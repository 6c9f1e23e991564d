"""The line over both wires: one contract, whichever side is the server."""

import asyncio
import threading
import time
from collections.abc import Callable, Coroutine, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from deploy.chaos.judge import judged
from deploy.demo.ports import free_ports
from station.errors import LineError
from station.plc.bus_log import BusLog, read_bus
from station.plc.line import ModbusLine, make_line
from station.plc.map.registers import (
    STATUS_START,
    STATUS_WORDS,
    CommandCode,
    Offline,
    Value,
    VerdictCode,
    unpack_window,
)
from station.plc.port import Command, Health, Trigger
from station.plc.simulated.line import Answer, SimulatedLine
from station.plc.simulated.windows import OwnWindows, RemoteWindows
from station.plc.wire.modbus import ModbusClient
from station.settings.model import PlcSettings

WELL = Health(ready=True, offline=Offline.NONE, failure=False, config_crc=7)


@dataclass
class Rig:
    """A station's line, and the PLC on the other end."""

    line: ModbusLine
    settings: PlcSettings
    windows: OwnWindows | RemoteWindows
    bus: BusLog
    folder: Path

    def plc(self, conversation: Callable[[SimulatedLine], Coroutine[Any, Any, Any]]) -> Any:
        """Run the PLC's side."""

        async def run() -> Any:
            plc = SimulatedLine(self.windows, accept_simulated=True)
            await plc.connect(5.0)
            try:
                return await conversation(plc)
            finally:
                await plc.close()

        return asyncio.run(run())

    async def status(self) -> dict[str, Value]:
        return unpack_window(STATUS_START, await self.windows.read(STATUS_START, STATUS_WORDS))


@pytest.fixture(params=["server", "client", "server, low word first", "client, low word first"])
def rig(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Rig]:
    mode = "server" if "server" in request.param else "client"
    swapped = "low" in request.param
    settings = PlcSettings(
        mode=mode, port=free_ports(1)[0], poll_ms=5, timeout_ms=800, deadline_ms=1500, low_word_first=swapped
    )
    bus = BusLog(tmp_path, days=1)
    line = make_line(settings, bus)
    line.start()
    line.check_in(WELL)
    windows: OwnWindows | RemoteWindows = OwnWindows("127.0.0.1", settings.port)
    if mode == "server":
        windows = RemoteWindows(lambda: ModbusClient("127.0.0.1", line.port))
    yield Rig(line, settings, windows, bus, tmp_path)
    line.stop()
    bus.close()


class Judging:
    """A cycle that answers all triggers alike."""

    def __init__(self, line: ModbusLine, verdict: VerdictCode, delay_s: float = 0.0) -> None:
        self._line, self._verdict, self._delay_s = line, verdict, delay_s
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self.triggers: list[Trigger] = []
        self.commands: list[Command] = []
        self.shown: list[bool] = []
        self.health = WELL

    def __enter__(self) -> "Judging":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def end(self) -> None:
        self._stop.set()
        self._thread.join(timeout=100)

    def _run(self) -> None:
        while not self._stop.is_set():
            self._line.check_in(self.health)
            request = self._line.next_request(0.02)
            if isinstance(request, Trigger):
                self.triggers.append(request)
                self._line.exposure_done(request)
                time.sleep(self._delay_s)
                result = judged(request, self._verdict, 1000 + len(self.triggers))
                self.shown.append(self._line.publish(result))
            elif isinstance(request, Command):
                self.commands.append(request)
                self._line.command_done(request, request.arg == 2)


def test_parts_pass_one_after_the_other(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> list[Answer]:
        return [await plc.inspect(f"PART-{i}") for i in range(3)]

    with Judging(rig.line, VerdictCode.OK) as judging:
        answers = rig.plc(conversation)
    assert [(a.accepted, a.refused_by, a.handshake_complete) for a in answers] == [(True, None, True)] * 3
    assert [t.serial for t in judging.triggers] == ["PART-0", "PART-1", "PART-2"]
    assert len({t.trigger_id for t in judging.triggers}) == 3
    assert judging.shown == [True] * 3


def test_the_bus_is_recorded_and_a_clean_part_breaks_no_rule(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> Answer:
        answer = await plc.inspect("PART-1")
        await plc.meanwhile(asyncio.sleep(0.3))  # the station wipes the rest of the record
        return answer

    with Judging(rig.line, VerdictCode.OK):
        assert rig.plc(conversation).handshake_complete
    rig.line.stop()
    rig.bus.close()
    recorded = list(read_bus(rig.folder))
    names = [(e.by, e.name, e.value) for e in recorded]
    order = [
        ("PLC", "TRIGGER", 1),
        ("station", "TRIGGER_ACK", 1),
        ("station", "VERDICT", "OK"),
        ("PLC", "RESULT_ACK", 1),
    ]
    assert [names.index(edge) for edge in order] == sorted(names.index(edge) for edge in order)
    assert ("station", "VERDICT", "NONE") in names[names.index(order[-1]) :]
    assert not [e for e in recorded if "rule broken" in e.note], recorded


def test_the_test_pattern_shows_the_word_order(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> list[int]:
        assert await plc.wait_ready(5.0)
        return await rig.windows.read(168, 4)

    with Judging(rig.line, VerdictCode.OK):
        words = rig.plc(conversation)
    high_first = [0x1234, 0x5678, 0x42F6, 0xE979]
    assert words == ([high_first[i] for i in (1, 0, 3, 2)] if rig.settings.low_word_first else high_first)


def test_nok_error_and_late_results_are_refused_and_the_next_part_goes_on(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> Answer:
        return await plc.inspect("ONE")

    for verdict in (VerdictCode.NOK, VerdictCode.ERROR, VerdictCode.TEST):
        with Judging(rig.line, verdict):
            answer = rig.plc(conversation)
        assert (answer.accepted, answer.verdict) == (False, verdict)
    with Judging(rig.line, VerdictCode.OK, delay_s=1.7) as judging:
        answer = rig.plc(conversation)
        time.sleep(0.5)
    assert (answer.accepted, answer.verdict) == (False, VerdictCode.ERROR)
    assert judging.shown == [False]


def test_a_master_is_judged_and_never_passes(rig: Rig) -> None:
    with Judging(rig.line, VerdictCode.TEST) as judging:
        answer = rig.plc(lambda plc: plc.inspect("MASTER-1", golden=True))
    assert judging.triggers[0].golden
    assert (answer.accepted, answer.verdict, answer.handshake_complete) == (False, VerdictCode.TEST, True)


def test_commands_are_carried_out_or_refused_and_parts_go_on(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> list[int | None]:
        assert await plc.wait_ready(5.0)
        echoes = [
            await plc.command(CommandCode.LOAD_RECIPE, 2),
            await plc.command(CommandCode.LOAD_RECIPE, 9),
            await plc.command(CommandCode.RESET_COUNTERS),
            await plc.command(CommandCode.TIME_SYNC),
            await plc.command(CommandCode.RESET),
            await plc.command(77),
        ]
        assert (await plc.inspect("AFTER")).accepted
        return echoes

    with Judging(rig.line, VerdictCode.OK) as judging:
        echoes = rig.plc(conversation)
    assert echoes == [2, 0xFFFF, 20, 21, 7, 0xFFFF]
    assert [(c.code, c.arg) for c in judging.commands] == [
        (CommandCode.LOAD_RECIPE, 2),
        (CommandCode.LOAD_RECIPE, 9),
    ]


def test_a_station_that_is_not_well_says_why_and_its_heartbeat_stands(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> tuple[Value, Value, Value]:
        assert await plc.wait_ready(5.0)
        judging.health = Health(ready=False, offline=Offline.CAMERA_LOST, failure=True, config_crc=7)
        await plc.meanwhile(asyncio.sleep(0.3))
        before = plc.status()["HEARTBEAT"]
        await plc.meanwhile(asyncio.sleep(0.4))
        return plc.status()["OFFLINE_REASON"], before, plc.status()["HEARTBEAT"]

    with Judging(rig.line, VerdictCode.OK) as judging:
        reason, before, after = rig.plc(conversation)
    assert (reason, before) == (Offline.CAMERA_LOST, after)


def test_a_stopped_station_leaves_no_verdict_and_takes_no_more(rig: Rig) -> None:
    async def conversation(plc: SimulatedLine) -> dict[str, Value] | None:
        assert (await plc.inspect("LAST")).accepted
        judging.end()
        await asyncio.to_thread(rig.line.stop)
        try:
            return await rig.status()
        except LineError:
            return None

    with Judging(rig.line, VerdictCode.OK) as judging:
        left = rig.plc(conversation)
    assert left is None or (left["VERDICT"], left["STATUS"]) == (0, 0)
    with pytest.raises(LineError, match="not running"):
        rig.line.check_in(WELL)

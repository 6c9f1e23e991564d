"""The station as client of a PLC that is silent, drops the link or takes half a write, at any addresses."""

import asyncio
import random
import socket
import threading
import time
from contextlib import suppress

import pytest

from deploy.chaos.judge import WELL, Judge, judged
from deploy.demo.ports import free_ports
from station.plc.line import make_line
from station.plc.map.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS, Offline, VerdictCode
from station.plc.port import Result, Trigger
from station.plc.simulated.line import Answer, SimulatedLine
from station.plc.simulated.windows import OwnWindows
from station.plc.wire.modbus import ModbusServer
from station.plc.wire.windows import RESULT_BITS, ClientWire, make_wire
from station.settings.model import PlcSettings


def ok(trigger: Trigger) -> Result:
    return judged(trigger, VerdictCode.OK)


class Proxy:
    """Between station and PLC: forwards, and at the n-th write misbehaves once, as set."""

    def __init__(self, plc_port: int, at_write: int, forward: bool) -> None:
        """`forward`: the PLC gets that write but the station no answer; otherwise neither gets anything."""
        self._plc_port, self._at, self._forward = plc_port, at_write, forward
        self._writes = 0
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._open: list[socket.socket] = []
        self._thread = threading.Thread(target=self._accept)
        self._thread.start()

    def close(self) -> None:
        self._listener.shutdown(socket.SHUT_RDWR)
        self._listener.close()
        self._thread.join(timeout=100)

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                station, _ = self._listener.accept()
                self._serve(station)

    def _serve(self, station: socket.socket) -> None:
        with station, suppress(OSError):
            plc = socket.create_connection(("127.0.0.1", self._plc_port), timeout=2)
            with plc:
                station.settimeout(2)
                while request := station.recv(4096):
                    if request[7] == 16:
                        self._writes += 1
                    cut = self._writes == self._at and request[7] == 16
                    if cut and not self._forward:
                        return
                    plc.sendall(request)
                    answer = plc.recv(4096)
                    if cut:
                        return
                    station.sendall(answer)


@pytest.fixture
def ports() -> int:
    return free_ports(1)[0]


@pytest.mark.parametrize("forward", [True, False])
@pytest.mark.parametrize("at_write", [3, 5, 6, 7, 8, 9, 10, 12])
def test_a_write_that_is_cut_anywhere_never_passes_a_part_that_is_not_ok(
    at_write: int, forward: bool, ports: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NOK and OK in turns: wherever the link is cut, OK is shown only for its own part; later parts pass."""
    monkeypatch.setattr("station.plc.wire.windows.RETRY_S", 0.05)
    windows = OwnWindows("127.0.0.1", ports)
    proxy = Proxy(ports, at_write, forward)
    settings = PlcSettings(mode="client", port=proxy.port, poll_ms=5, timeout_ms=200, deadline_ms=1500)
    line = make_line(settings)

    def decide(trigger: Trigger) -> Result:
        verdict = VerdictCode.NOK if trigger.serial.startswith("BAD") else VerdictCode.OK
        return judged(trigger, verdict)

    async def conversation() -> list[Answer]:
        plc = SimulatedLine(windows, accept_simulated=False)
        await plc.connect(5)
        line.start()
        try:
            return [await plc.inspect(serial, 3.0) for serial in ("GOOD-1", "BAD-2", "GOOD-3", "GOOD-4")]
        finally:
            await plc.close()

    try:
        with Judge(LateStart(line), decide):  # type: ignore[arg-type]
            answers = asyncio.run(conversation())
    finally:
        line.stop()
        proxy.close()
    assert not answers[1].accepted
    assert [a.accepted for a in (answers[0], answers[2], answers[3])].count(True) >= 2, answers
    assert answers[3].accepted


class LateStart:
    """A line that is not asked before it runs."""

    def __init__(self, line: object) -> None:
        self._line = line

    def __getattr__(self, name: str) -> object:
        return getattr(self._line, name)

    def check_in(self, health: object) -> None:
        if self._line._loop is None:  # type: ignore[attr-defined]
            time.sleep(0.01)
        else:
            self._line.check_in(health)  # type: ignore[attr-defined]


def test_a_mute_plc_is_told_and_nothing_blocks(ports: int, caplog: pytest.LogCaptureFixture) -> None:
    with socket.create_server(("127.0.0.1", ports)):
        line = make_line(PlcSettings(mode="client", port=ports, timeout_ms=2000, plc_heartbeat_ms=300))
        line.start()
        try:
            until = time.monotonic() + 100
            while line.state().offline is not Offline.PLC_SILENT and time.monotonic() < until:
                start = time.monotonic()
                line.check_in(WELL)
                assert line.next_request(0.01) is None
                assert time.monotonic() - start < 1.0, "half of the time for which an answer is waited for"
            assert line.state().offline is Offline.PLC_SILENT
        finally:
            line.stop()
    assert "No response" in caplog.text


def test_a_plc_that_is_not_there_is_waited_for(ports: int) -> None:
    line = make_line(PlcSettings(mode="client", port=ports, poll_ms=5, timeout_ms=200))
    line.start()

    async def conversation() -> Answer:
        await asyncio.sleep(0.7)
        plc = SimulatedLine(OwnWindows("127.0.0.1", ports), accept_simulated=False)
        await plc.connect(50)
        try:
            return await plc.inspect("LATE", 20.0)
        finally:
            await plc.close()

    try:
        with Judge(line, ok):
            assert asyncio.run(conversation()).accepted
    finally:
        line.stop()


def test_a_wrong_base_address_is_said_with_its_register(ports: int, caplog: pytest.LogCaptureFixture) -> None:
    line = make_line(
        PlcSettings(
            mode="client", port=ports, poll_ms=5, timeout_ms=200, status_base=4000, plc_heartbeat_ms=300
        )
    )

    def said() -> bool:
        return "4000 refused" in caplog.text

    def silent() -> bool:
        return line.state().offline is Offline.PLC_SILENT

    async def conversation() -> int:
        windows = OwnWindows("127.0.0.1", ports)
        await windows.connect()
        line.start()
        until = time.monotonic() + 100
        while not (said() and silent()) and time.monotonic() < until:
            await asyncio.sleep(0.02)
        words = await windows.read(STATUS_START, STATUS_WORDS)
        await asyncio.to_thread(line.stop)
        await windows.close()
        return sum(words)

    assert asyncio.run(conversation()) == 0
    assert said()
    assert silent()


def test_windows_that_overlap_are_refused() -> None:
    with pytest.raises(ValueError, match="overlap"):
        PlcSettings(mode="client", command_base=90, status_base=100)


def test_between_two_records_the_plc_reads_only_bits_that_hold_before_and_after(ports: int) -> None:
    """No bit that the next status lacks may outlive a result: a stale READY would be taken for a new one."""
    rng, words = random.Random(7), STATUS_START + STATUS_WORDS

    async def publish_many() -> None:
        plc = ModbusServer(
            "127.0.0.1",
            ports,
            words=words,
            writable=range(STATUS_START, words),
            on_write=lambda: looks.append(asyncio.create_task(look())),
        )
        looks: list[asyncio.Task[None]] = []
        seen: list[int] = []

        async def look() -> None:
            seen.extend(await plc.read(STATUS_START, 1))

        await plc.start()
        wire = ClientWire(
            "127.0.0.1",
            ports,
            unit=1,
            bases=(0, STATUS_START),
            command_function=3,
            poll_s=0.005,
            timeout_s=1.0,
            low_word_first=False,
            tls=None,
        )
        await wire.read_command()
        before = [0] * STATUS_WORDS
        for head in range(1, 200):
            after = [rng.getrandbits(16), 0, head, *(rng.getrandbits(16) for _ in range(STATUS_WORDS - 3))]
            seen.clear()
            await wire.publish(after)
            await asyncio.gather(*looks)
            assert await plc.read(STATUS_START, STATUS_WORDS) == after
            for status in seen:
                assert status in (before[0], after[0]) or (
                    status & before[0] & after[0] == status and not status & RESULT_BITS
                )
            assert before[0] & RESULT_BITS == 0 or (before[0] & after[0] & ~RESULT_BITS & 0xFFFF) in seen
            before = after
        await wire.close()
        await plc.stop()

    asyncio.run(publish_many())


@pytest.mark.parametrize(
    ("preset", "function", "command", "status"),
    [("codesys", 4, 0, 0), ("twincat", 3, 12288, 12388), ("openplc", 3, 1024, 1124), ("tia", 3, 0, 100)],
)
def test_a_preset_reads_and_writes_where_the_tool_has_its_memory(
    preset: str, function: int, command: int, status: int, ports: int
) -> None:
    """A PLC with two tables, as CODESYS has them: what it sends is read by function 4 alone."""
    seen: list[tuple[int, int]] = []

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        with suppress(asyncio.IncompleteReadError, ConnectionError):
            while True:
                head = await reader.readexactly(6)
                body = await reader.readexactly(int.from_bytes(head[4:], "big"))
                seen.append((body[1], int.from_bytes(body[2:4], "big")))
                words = b"" if body[1] == 16 else bytes(2 * int.from_bytes(body[4:6], "big"))
                answer = body[:6] if body[1] == 16 else bytes([*body[:2], len(words)]) + words
                writer.write(head[:4] + len(answer).to_bytes(2, "big") + answer)
        writer.close()
        with suppress(ConnectionError):
            await writer.wait_closed()
        ended.set()

    async def run() -> None:
        async with await asyncio.start_server(serve, "127.0.0.1", ports):
            wire = make_wire(PlcSettings(mode="client", port=ports, preset=preset))  # type: ignore[arg-type]
            assert len(await wire.read_command()) == COMMAND_WORDS
            await wire.close()
            await ended.wait()

    ended = asyncio.Event()
    asyncio.run(run())
    assert (function, command) in seen
    assert {entry for entry in seen if entry[0] == 16} == {(16, status), (16, status + 1)}


def test_a_preset_fills_in_only_what_is_not_set() -> None:
    settings = PlcSettings(mode="client", preset="openplc", command_base=1030)
    assert (settings.command_base, settings.status_base, settings.command_function) == (1030, 1124, 3)
    with pytest.raises(ValueError, match="only for mode"):
        PlcSettings(preset="tia")
    with pytest.raises(ValueError, match="codesys"):
        PlcSettings.model_validate({"mode": "client", "preset": "step7"})

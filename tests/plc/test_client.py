"""The station as client of a PLC that is silent, drops the link or takes half a write, at any addresses."""

import asyncio
import random
import socket
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import closing, suppress

import pytest

from deploy.chaos.judge import WELL, Judge, judged
from deploy.demo.ports import free_ports
from station.errors import LineError, SettingsError
from station.plc.line import ModbusLine, make_line
from station.plc.map.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS, Offline, VerdictCode
from station.plc.port import Result, Trigger
from station.plc.simulated.line import Answer, SimulatedLine
from station.plc.simulated.windows import Windows
from station.plc.wire.windows import RESULT_BITS, make_wire
from station.settings.model import PlcSettings
from station.settings.plc import S7Settings
from tests.plc.spoken import ModbusPeer, Peer, S7Peer


def ok(trigger: Trigger) -> Result:
    return judged(trigger, VerdictCode.OK)


class Proxy:
    """Between station and PLC: forwards, and at the n-th write misbehaves once, as set."""

    def __init__(self, peer: Peer, plc_port: int, at_write: int, forward: bool) -> None:
        """`forward`: the PLC gets that write but the station no answer; otherwise neither gets anything."""
        self._peer, self._plc_port, self._at, self._forward = peer, plc_port, at_write, forward
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
                    writes = self._peer.writes(request)
                    self._writes += writes
                    cut = self._writes == self._at and writes
                    if cut and not self._forward:
                        return
                    plc.sendall(request)
                    answer = plc.recv(4096)
                    if cut:
                        return
                    station.sendall(answer)


def passed(
    line: ModbusLine,
    windows: Windows,
    decide: Callable[[Trigger], Result],
    serials: Sequence[str],
    *,
    connect_s: float,
    window_s: float,
) -> list[Answer]:
    """Pass parts through a line that starts once the PLC is there; return what the PLC got."""

    async def conversation() -> list[Answer]:
        plc = SimulatedLine(windows, accept_simulated=False)
        await plc.connect(connect_s)
        line.start()
        try:
            return [await plc.inspect(serial, window_s) for serial in serials]
        finally:
            await plc.close()

    try:
        with Judge(LateStart(line), decide):  # type: ignore[arg-type]
            return asyncio.run(conversation())
    finally:
        line.stop()


@pytest.fixture
def ports() -> int:
    return free_ports(1)[0]


@pytest.fixture(params=[ModbusPeer, S7Peer], ids=["modbus", "s7"])
def peer(request: pytest.FixtureRequest) -> Peer:
    return request.param()  # type: ignore[no-any-return]


@pytest.mark.parametrize("forward", [True, False])
@pytest.mark.parametrize("at_write", [3, 5, 6, 7, 8, 9, 10, 12])
def test_a_write_that_is_cut_anywhere_never_passes_a_part_that_is_not_ok(
    at_write: int, forward: bool, peer: Peer, ports: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """NOK and OK in turns: wherever the link is cut, OK is shown only for its own part; later parts pass."""
    monkeypatch.setattr("station.plc.wire.windows.RETRY_S", 0.05)
    windows = peer.windows(ports)
    proxy = Proxy(peer, ports, at_write, forward)
    settings = peer.settings(proxy.port, poll_ms=5, timeout_ms=200, deadline_ms=1500)
    line = make_line(settings)

    def decide(trigger: Trigger) -> Result:
        verdict = VerdictCode.NOK if trigger.serial.startswith("BAD") else VerdictCode.OK
        return judged(trigger, verdict)

    serials = ("GOOD-1", "BAD-2", "GOOD-3", "GOOD-4")
    with closing(proxy):
        answers = passed(line, windows, decide, serials, connect_s=5, window_s=3.0)
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


def test_a_mute_plc_is_told_and_nothing_blocks(
    peer: Peer, ports: int, caplog: pytest.LogCaptureFixture
) -> None:
    with socket.create_server(("127.0.0.1", ports)):
        line = make_line(peer.settings(ports, timeout_ms=2000, plc_heartbeat_ms=300))
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
    assert peer.mute in caplog.text


def test_a_plc_that_is_not_there_is_waited_for(peer: Peer, ports: int) -> None:
    line = make_line(peer.settings(ports, poll_ms=5, timeout_ms=200))
    line.start()

    async def conversation() -> Answer:
        await asyncio.sleep(0.7)
        plc = SimulatedLine(peer.windows(ports), accept_simulated=False)
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


def test_a_wrong_base_address_is_said_with_its_register(
    peer: Peer, ports: int, caplog: pytest.LogCaptureFixture
) -> None:
    settings = peer.settings(ports, poll_ms=5, timeout_ms=200, status_base=4000, plc_heartbeat_ms=300)
    line = make_line(settings)

    def said() -> bool:
        return peer.refused in caplog.text

    def silent() -> bool:
        return line.state().offline is Offline.PLC_SILENT

    async def conversation() -> int:
        windows = peer.windows(ports)
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


def test_between_two_records_the_plc_reads_only_bits_that_hold_before_and_after(
    peer: Peer, ports: int
) -> None:
    """No bit that the next status lacks may outlive a result: a stale READY would be taken for a new one."""
    rng = random.Random(7)

    async def publish_many() -> None:
        seen = peer.status_seen
        plc = peer.windows(ports)
        await plc.connect()
        wire = make_wire(peer.settings(ports, poll_ms=5, timeout_ms=1000))
        await wire.read_command()
        before = [0] * STATUS_WORDS
        for head in range(1, 200):
            after = [rng.getrandbits(16), 0, head, *(rng.getrandbits(16) for _ in range(STATUS_WORDS - 3))]
            seen.clear()
            await wire.publish(after)
            assert await plc.read(STATUS_START, STATUS_WORDS) == after
            for status in seen:
                assert status in (before[0], after[0]) or (
                    status & before[0] & after[0] == status and not status & RESULT_BITS
                )
            assert before[0] & RESULT_BITS == 0 or (before[0] & after[0] & ~RESULT_BITS & 0xFFFF) in seen
            before = after
        await wire.close()
        assert await plc.read(STATUS_START, STATUS_WORDS) == [0] * STATUS_WORDS
        await plc.close()

    asyncio.run(publish_many())


@pytest.mark.parametrize("low_word_first", [False, True])
def test_parts_pass_on_their_own_verdict_alone(peer: Peer, ports: int, low_word_first: bool) -> None:
    line = make_line(peer.settings(ports, poll_ms=5, low_word_first=low_word_first))
    windows = peer.windows(ports, low_word_first=low_word_first)

    def decide(trigger: Trigger) -> Result:
        return judged(trigger, VerdictCode.NOK if trigger.trigger_id % 3 == 0 else VerdictCode.OK)

    serials = [f"P-{number}" for number in range(1, 25)]
    answers = passed(line, windows, decide, serials, connect_s=50, window_s=30.0)
    assert [answer.accepted for answer in answers] == [answer.trigger_id % 3 != 0 for answer in answers]
    assert [answer.verdict for answer in answers].count(VerdictCode.NOK) == 8
    assert all(answer.handshake_complete for answer in answers)


@pytest.mark.parametrize("name", ["tls", "preset", "command_function", "unit"])
def test_what_is_of_modbus_alone_is_refused_beside_s7(name: str) -> None:
    value = {"tls": {}, "preset": "tia", "command_function": 3, "unit": 1}[name]
    with pytest.raises(ValueError, match=f"{name}: only for Modbus"):
        PlcSettings.model_validate({"mode": "client", "s7": {"db": 10}, name: value})


def test_s7_is_off_by_default_and_for_clients_alone() -> None:
    assert PlcSettings().s7 is None
    assert PlcSettings.model_validate({"mode": "client", "s7": {"db": 10}}).port == 102
    with pytest.raises(ValueError, match="only for mode"):
        PlcSettings.model_validate({"s7": {"db": 10}})
    for wrong in ({"db": 0}, {}, {"db": 10, "rack": 8}, {"db": 10, "slot": 32}):
        with pytest.raises(ValueError, match=r"s7\."):
            PlcSettings.model_validate({"mode": "client", "s7": wrong})


def test_the_missing_package_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "snap7.async_client", None)
    with pytest.raises(SettingsError, match=r"pip install 'weldgate\[s7\]'"):
        make_line(PlcSettings(mode="client", s7=S7Settings(db=10)))


def test_a_plc_with_another_data_block_is_told_by_name(ports: int, caplog: pytest.LogCaptureFixture) -> None:
    async def run() -> None:
        plc = S7Peer().windows(ports)
        await plc.connect()
        wire = make_wire(PlcSettings(mode="client", port=ports, s7=S7Settings(db=11)))
        with pytest.raises(LineError, match="of DB11"):
            await wire.read_command()
        await wire.close()
        await plc.close()

    asyncio.run(run())


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

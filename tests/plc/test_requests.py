"""What a driver can send by mistake: the right exception, nothing changed, said once with a count."""

import asyncio
import socket
import struct
from ipaddress import ip_network
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deploy.demo.ports import free_ports
from station.cli.check import check
from station.plc.line import ModbusLine, make_line
from station.plc.wire.access import Access, Complaints
from station.plc.wire.framing import refusal
from station.plc.wire.modbus import ModbusClient, ModbusServer
from station.plc.wire.requests import FUNCTIONS, exception
from station.settings.model import PlcSettings
from tests.plc.test_access import serve

REGISTERS = 176


def body(function: int, form: str, *values: int) -> bytes:
    return struct.pack(f">B{form}", function, *values)


@pytest.mark.parametrize(
    ("request_body", "code"),
    [
        (body(3, "HH", 0, 0), 3),
        (body(3, "HH", 0, 126), 3),
        (body(4, "HH", 0, 126), 3),
        (body(1, "HH", 0, 2001), 3),
        (body(2, "HH", 0, 0), 3),
        (body(3, "HH", 0, 125), None),
        (body(3, "HH", 52, 125), 2),
        (body(3, "HH", 65535, 2), 2),
        (body(1, "HH", REGISTERS * 16 - 1, 1), None),
        (body(1, "HH", REGISTERS * 16, 1), 2),
        (body(3, "HHB", 0, 1, 9), 3),
        (body(3, "H", 0), 3),
        (body(5, "HH", 0, 0xFF00), None),
        (body(5, "HH", 0, 1), 3),
        (body(5, "HH", 0, 0xFFFF), 3),
        (body(6, "HH", REGISTERS, 1), 2),
        (body(15, "HHBB", 0, 8, 1, 255), None),
        (body(15, "HHBB", 0, 9, 1, 255), 3),
        (body(15, "HHB", 0, 0, 0), 3),
        (body(16, "HHBH", 0, 1, 2, 7), None),
        (body(16, "HHBH", 0, 2, 2, 7), 3),
        (body(16, "HHBH", 0, 1, 4, 7), 3),
        (body(16, "HHB", 0, 0, 0), 3),
        (body(16, "HHB", 0, 124, 248) + bytes(248), 3),
        (body(22, "HHH", 0, 1, 1), None),
        (body(22, "HH", 0, 1), 3),
        (body(23, "HHHHBH", 100, 1, 0, 1, 2, 7), None),
        (body(23, "HHHHBH", 100, 126, 0, 1, 2, 7), 3),
        (body(23, "HHHHBH", 100, 1, 0, 0, 2, 7), 3),
        (body(23, "HHHHBH", REGISTERS, 1, 0, 1, 2, 7), 2),
        (body(43, "BBB", 14, 1, 0), None),
        (body(43, "BBB", 14, 4, 1), None),
        (body(43, "BBB", 14, 4, 3), 2),
        (body(43, "BBB", 14, 5, 0), 3),
        (body(43, "BBB", 13, 1, 0), 1),
        (body(43, "B", 14), 3),
        (body(7, ""), 1),
        (body(99, "HH", 0, 1), 1),
    ],
)
def test_every_value_is_checked_in_the_order_of_the_specification(
    request_body: bytes, code: int | None
) -> None:
    assert exception(request_body, REGISTERS) == code


@given(st.integers(0, 255), st.binary(max_size=252))
def test_no_request_breaks_the_check_and_unknown_functions_are_named_as_such(
    function: int, data: bytes
) -> None:
    code = exception(bytes([function]) + data, REGISTERS)
    assert code in (None, 1, 2, 3)
    assert (code == 1) == (function not in FUNCTIONS or (function == 43 and data[:1] != b"\x0e"))


def test_wrong_requests_get_their_code_over_the_wire_and_change_nothing(line: ModbusLine) -> None:
    wrong = [(3, 126, 3), (3, 0, 3), (4, 126, 3), (1, 2001, 3), (2, 0, 3), (5, 7, 3), (99, 1, 1)]
    with socket.create_connection(("127.0.0.1", line.port), timeout=20) as peer:
        for function, count, code in wrong:
            frame = struct.pack(">HHHBBHH", 1, 0, 6, 1, function, 0, count)
            peer.sendall(frame)
            assert peer.recv(64) == refusal(frame, code)
        peer.sendall(struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 0, 23))
        assert peer.recv(256)[9:] == bytes(46)


def test_a_burst_is_answered_in_turn_and_the_connection_stays(line: ModbusLine) -> None:
    """Clients that poll each register with a request of its own, all at once, also cut anywhere."""
    asked = 420
    burst = b"".join(struct.pack(">HHHBBHH", i, 0, 6, 1, 3, 138 + i % 21, 1) for i in range(asked))
    with socket.create_connection(("127.0.0.1", line.port), timeout=60) as peer:
        stream = peer.makefile("rb")
        for cut in (0, 7, 1001):
            peer.sendall(burst[:cut])
            peer.sendall(burst[cut:])
            answers = [stream.read(11) for _ in range(asked)]
            assert [int.from_bytes(answer[:2], "big") for answer in answers] == list(range(asked))
            assert all(answer[7] == 3 for answer in answers)
        stream.close()


def test_a_peer_that_reads_no_answers_is_held_back_and_ended(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr("station.plc.wire.modbus.peer.UNREAD_S", 0.3)

    async def conversation(server: ModbusServer) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", server.port, limit=1024)
        writer.transport.pause_reading()  # type: ignore[attr-defined]
        ask = struct.pack(">HHHBBHH", 1, 0, 6, 1, 3, 0, 125) * 1000
        sent = 0
        while "does not read" not in caplog.text:
            if writer.transport.get_write_buffer_size() < len(ask) and not writer.is_closing():
                writer.write(ask)
                sent += 1
            await asyncio.sleep(0.005)
            assert sent < 5000, "60 MB of requests were taken in"
        writer.transport.abort()
        del reader

    serve(conversation)


def test_only_named_peers_write_and_a_refusal_is_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    async def conversation(server: ModbusServer) -> None:
        client = ModbusClient("127.0.0.1", server.port)
        for _ in range(5):
            await client.connect()
            with pytest.raises(Exception, match="exception_code=1"):
                await client.write(0, [1])
        assert await server.read(0, 1) == [0]
        client.close()

    serve(conversation, access=Access(writers=(ip_network("192.0.2.7"),)))
    said = [record.message for record in caplog.records if "plc.writers" in record.message]
    assert len(said) == 2
    assert "4 more" in said[1]


def test_a_plc_whose_right_to_write_another_peer_took_is_named_in_the_log(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def conversation(server: ModbusServer) -> None:
        other, plc = (ModbusClient("127.0.0.1", server.port) for _ in range(2))
        await other.connect()
        await other.write(0, [1])
        await plc.connect()
        with pytest.raises(Exception, match="exception_code=6"):
            await plc.write(0, [2])
        other.close()
        plc.close()

    serve(conversation)
    assert "may not write: 127.0.0.1 has the right to write; name the PLC under plc.writers" in caplog.text


def test_fifteen_hundred_bad_packets_are_two_lines(
    caplog: pytest.LogCaptureFixture,
) -> None:
    async def conversation(server: ModbusServer) -> None:
        for number in range(500):
            reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
            writer.write(struct.pack(">HHHB", number, 0, 255 + number, 1))
            assert await reader.read() == b""
            writer.close()
        reader, writer = await asyncio.open_connection("127.0.0.1", server.port)
        for number in range(1000):
            writer.write(struct.pack(">HHHBBHH", number, 0, 6, 1, 3, number, 126 + number))
            assert (await reader.readexactly(9))[8] == 3
        writer.close()

    serve(conversation)
    lines = [record.message for record in caplog.records]
    assert len(lines) == 4, lines
    assert "499 more" in lines[2]
    assert "999 more" in lines[3]


def test_many_peers_are_counted_together_and_nothing_is_forgotten(caplog: pytest.LogCaptureFixture) -> None:
    async def run() -> None:
        complaints = Complaints()
        for number in range(3000):
            complaints.note(f"10.0.{number // 250}.{number % 250}", "does not speak Modbus")
        complaints.close()

    asyncio.run(run())
    assert len(caplog.records) == 1002
    assert "others does not speak Modbus: 1999 more" in caplog.text


@pytest.mark.parametrize(("host", "allow", "said"), [("0.0.0.0", (), True), ("127.0.0.1", (), False)])
def test_an_empty_list_of_peers_is_said(
    host: str, allow: tuple[()], said: bool, caplog: pytest.LogCaptureFixture
) -> None:
    line = make_line(PlcSettings(host=host, port=free_ports(1)[0], allow=allow))
    line.start()
    line.stop()
    assert ("plc.allow is empty" in caplog.text) is said


@pytest.mark.parametrize(
    ("section", "said"),
    [
        ('host = "0.0.0.0"', True),
        ('host = "0.0.0.0"\nallow = ["10.0.0.0/24"]', False),
        ('host = "127.0.0.1"', False),
        ('host = "::1"', False),
        ('mode = "client"\nhost = "192.0.2.1"', False),
    ],
)
def test_check_names_an_empty_list_of_peers(
    section: str, said: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for probe in ("_model", "_archive", "_camera", "_plc"):
        monkeypatch.setattr(f"station.cli.check.{probe}", lambda *_: None)
    path = tmp_path / "station.toml"
    path.write_text(f'[camera]\nkind = "replay"\nfolder = "images"\n[plc]\n{section}\n')
    found = dict(check(path))
    assert found["settings"] is None
    assert any("plc.allow is empty" in name for name in found) is said

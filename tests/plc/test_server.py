"""The server over loopback, with pymodbus' own client as the peer."""

import asyncio
import socket
import time
from dataclasses import replace

import pytest
from pymodbus.client import AsyncModbusTcpClient

from deploy.chaos.judge import judged
from station.errors import LineError
from station.plc.line import ModbusLine, make_line
from station.plc.map.registers import COMMAND_WORDS, STATUS_START, STATUS_WORDS, Flags, VerdictCode
from station.plc.port import Trigger
from station.settings.model import PlcSettings

pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning:pymodbus")


def talk(line: ModbusLine, conversation: object) -> object:
    async def run() -> object:
        client = AsyncModbusTcpClient("127.0.0.1", port=line.port, timeout=20, retries=0)
        assert await client.connect()
        try:
            return await conversation(client)  # type: ignore[operator]
        finally:
            client.close()

    return asyncio.run(run())


def test_every_register_reads_by_both_functions_and_every_unit(line: ModbusLine) -> None:
    async def conversation(client: AsyncModbusTcpClient) -> None:
        for unit in (0, 1, 255):
            holding = await client.read_holding_registers(168, count=4, device_id=unit)
            inputs = await client.read_input_registers(168, count=4, device_id=unit)
            assert holding.registers == inputs.registers == [0x1234, 0x5678, 0x42F6, 0xE979]
        bits = await client.read_coils(1600, count=16)
        assert bits.bits[:16] == (await client.read_discrete_inputs(1600, count=16)).bits[:16]
        identity = await client.read_device_information(read_code=1)
        assert identity.information[0] == b"weldgate"

    talk(line, conversation)


def test_the_status_window_is_closed_to_writers(line: ModbusLine) -> None:
    async def conversation(client: AsyncModbusTcpClient) -> None:
        attempts = [
            client.write_register(105, 1),
            client.write_registers(100, [0xFFFF] * 10),
            client.write_coil(1606, True),
            client.write_coils(1600, [True] * 16),
            client.write_coils(0, [True] * 1968),
            client.write_coils((COMMAND_WORDS - 1) * 16, [True] * 32),
            client.write_registers(COMMAND_WORDS - 3, [0] * 6),
            client.mask_write_register(address=105, and_mask=0, or_mask=1),
            client.readwrite_registers(read_address=100, read_count=2, write_address=105, values=[1]),
        ]
        for attempt in attempts:
            answer = await attempt
            assert answer.isError()
            assert answer.exception_code == 2
        assert (await client.read_holding_registers(105, count=1)).registers == [0]

    talk(line, conversation)


def test_a_bit_written_as_a_coil_is_seen(line: ModbusLine) -> None:
    async def conversation(client: AsyncModbusTcpClient) -> int:
        await client.write_coil(0, True)
        for _ in range(100):
            status = (await client.read_holding_registers(100, count=1)).registers[0]
            if status & 2:
                return status
            await asyncio.sleep(0.01)
        return 0

    assert isinstance(bits := talk(line, conversation), int)
    assert bits & 3 == 3


def test_a_result_is_readable_when_publish_returns(line: ModbusLine) -> None:
    async def start(client: AsyncModbusTcpClient) -> None:
        await client.write_registers(0, [1, 1, 77])
        await asyncio.sleep(0.05)
        await client.write_register(0, 3)

    talk(line, start)
    trigger = line.next_request(2.0)
    assert isinstance(trigger, Trigger)
    assert trigger.trigger_id == 77
    assert line.awaits_result(trigger)
    result = replace(judged(trigger, VerdictCode.NOK, 70000), reason=1, seg_nok_mask=8, flags=Flags.SIMULATED)
    assert line.publish(result)

    async def read(client: AsyncModbusTcpClient) -> list[int]:
        return list((await client.read_holding_registers(STATUS_START, count=STATUS_WORDS)).registers)

    words = talk(line, read)
    assert isinstance(words, list)
    assert words[5:9] == [2, 0xFFFD, 1, 70000 - 65536]
    assert words[4] == 77
    assert words[2] == words[75]
    assert words[74] == 1


def test_a_taken_port_is_said_in_one_line() -> None:
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        server = make_line(PlcSettings(port=holder.getsockname()[1]))
        with pytest.raises(LineError, match=r"plc\.port"):
            server.start()
        server.stop()


def test_noise_on_the_wire_changes_nothing(line: ModbusLine) -> None:
    for junk in (
        b"",
        b"\x00" * 300,
        b"GET / HTTP/1.0\r\n\r\n",
        b"\x00\x01\x00\x00\xff\xff\x01\x10" + b"\xff" * 250,
    ):
        with socket.create_connection(("127.0.0.1", line.port), timeout=20) as peer:
            peer.sendall(junk)
    time.sleep(0.1)

    async def read(client: AsyncModbusTcpClient) -> list[int]:
        return list((await client.read_holding_registers(105, count=2)).registers)

    assert talk(line, read) == [0, 0xFFFF]

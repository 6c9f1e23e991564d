"""Clients of other authors: pyModbusTCP, and modbus-serial of Node.js, each beside parallel polls."""

import os
import shutil
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from pyModbusTCP.client import ModbusClient

from deploy.chaos.judge import Judge, judged
from station.plc.line import ModbusLine
from station.plc.map.registers import (
    BY_NAME,
    STATUS_START,
    STATUS_WORDS,
    TEST_U32,
    Control,
    Status,
    VerdictCode,
    pack,
)
from station.plc.port import Result, Trigger

HERE = Path(__file__).resolve().parent
PARTS, READERS = 60, 4
PATIENCE_S = 60.0
AT = {name: register.address - STATUS_START for name, register in BY_NAME.items()}


def decide(trigger: Trigger) -> Result:
    return judged(trigger, VerdictCode.OK if trigger.trigger_id % 3 else VerdictCode.NOK)


class OutsidePlc:
    """A PLC of pyModbusTCP."""

    def __init__(self, port: int) -> None:
        self.client = ModbusClient("127.0.0.1", port, timeout=PATIENCE_S, auto_open=True)
        self.beat = 0

    def control(self, bits: Control) -> None:
        self.beat += 1
        assert self.client.write_multiple_registers(0, [int(bits), self.beat]), self.client.last_error_as_txt

    def until(self, bit: Status, wanted: bool, held: Control) -> list[int]:
        end_s = time.monotonic() + PATIENCE_S
        while time.monotonic() < end_s:
            window = self.client.read_holding_registers(STATUS_START, STATUS_WORDS)
            assert window is not None, self.client.last_error_as_txt
            if bool(window[0] & bit) is wanted:
                return list(window)
            self.control(held)
        raise AssertionError(f"{bit.name} did not become {wanted}")

    def part(self, number: int) -> list[int]:
        self.until(Status.READY, True, Control.ENABLE)
        assert self.client.write_multiple_registers(5, pack(BY_NAME["PART_SERIAL"], f"C-{number}"))
        assert self.client.write_single_register(2, number)
        self.control(Control.ENABLE | Control.TRIGGER)
        self.until(Status.TRIGGER_ACK, True, Control.ENABLE | Control.TRIGGER)
        self.control(Control.ENABLE)
        window = self.until(Status.RESULT_VALID, True, Control.ENABLE)
        self.control(Control.ENABLE | Control.RESULT_ACK)
        self.until(Status.RESULT_VALID, False, Control.ENABLE | Control.RESULT_ACK)
        self.control(Control.ENABLE)
        return window


def test_pymodbustcp_does_the_whole_handshake_beside_parallel_readers(line: ModbusLine) -> None:
    stop, read = threading.Event(), [0] * READERS
    failed: list[str] = []

    def poll(number: int) -> None:
        client = ModbusClient("127.0.0.1", line.port, timeout=PATIENCE_S, auto_open=True)
        ask = client.read_input_registers if number % 2 else client.read_holding_registers
        while not stop.is_set():
            for address in range(AT["SEG_SCORE"], AT["SEG_SCORE"] + 21):
                words, bits = ask(STATUS_START + address, 1), client.read_coils(STATUS_START * 16, 16)
                if words is None or bits is None:
                    failed.append(client.last_error_as_txt)
                read[number] += 1
        client.close()

    readers = [threading.Thread(target=poll, args=(number,)) for number in range(READERS)]
    for reader in readers:
        reader.start()
    plc = OutsidePlc(line.port)
    try:
        with Judge(line, decide):
            windows = [plc.part(number) for number in range(1, PARTS + 1)]
    finally:
        stop.set()
        for reader in readers:
            reader.join()
        plc.client.close()
    assert failed == []
    assert min(read) > 20
    for number, window in enumerate(windows, start=1):
        verdict = 1 if number % 3 else 2
        assert window[AT["VERDICT"]] == verdict
        assert window[AT["RESULT_TRIGGER_ID"]] == number
        assert window[AT["SEQ_HEAD"]] == window[AT["SEQ_TAIL"]]
        assert window[AT["TEST_U32"] : AT["TEST_U32"] + 2] == [TEST_U32 >> 16, TEST_U32 & 0xFFFF]


def test_pymodbustcp_is_told_by_name_what_it_may_not_do(line: ModbusLine) -> None:
    client = ModbusClient("127.0.0.1", line.port, timeout=PATIENCE_S, auto_open=True)
    assert not client.write_single_register(STATUS_START, 1)
    assert client.last_except == 2
    assert client.read_holding_registers(60_000, 1) is None
    assert client.last_except == 2
    client.close()


def test_modbus_serial_does_the_whole_handshake_beside_its_own_polls_of_single_registers(
    line: ModbusLine,
) -> None:
    node = shutil.which("node", path=os.pathsep.join((str(Path(sys.executable).parent), os.environ["PATH"])))
    assert node, "make setup installs node"
    if not (HERE / "npm/node_modules/modbus-serial").is_dir():
        pytest.skip("modbus-serial is not installed: make setup could not reach npm's registry")
    program = [node, str(HERE / "npm/plc.js"), *map(str, (line.port, STATUS_START, STATUS_WORDS, PARTS))]
    with Judge(line, decide):
        done = subprocess.run(program, capture_output=True, text=True, timeout=800, check=False)
    assert done.returncode == 0, done.stderr
    parts, passed, refused, failed, polls, failed_polls = map(int, done.stdout.split())
    assert (parts, passed, refused, failed) == (PARTS, PARTS - PARTS // 3, PARTS // 3, 0)
    assert polls > 200
    assert failed_polls == 0

"""Foreign peers: mbpoll and libmodbus."""

import asyncio
import re
import shutil
import subprocess
import threading
from pathlib import Path

import pytest

from deploy.chaos.judge import Judge, judged
from station.plc.line import ModbusLine
from station.plc.map.registers import COMMAND_WORDS, MAP, STATUS_START, STATUS_WORDS, VerdictCode
from station.plc.port import Result, Trigger
from station.plc.simulated.windows import RemoteWindows

HERE = Path(__file__).resolve().parent


def mbpoll(line: ModbusLine, *arguments: str) -> tuple[int, str]:
    assert shutil.which("mbpoll"), "deploy/system.sh test installs mbpoll"
    done = subprocess.run(
        ["mbpoll", "-1", "-p", str(line.port), *arguments],
        capture_output=True,
        text=True,
        timeout=200,
        check=False,
        stdin=subprocess.DEVNULL,
    )
    return done.returncode, done.stdout + done.stderr


def values(text: str) -> dict[int, int]:
    """References and words of a `:hex` answer."""
    return {int(at): int(word, 16) for at, word in re.findall(r"\[(\d+)\]:\s+0x([0-9A-F]+)", text)}


@pytest.mark.parametrize(("first", "zero_based"), [(0, True), (1, False)])
@pytest.mark.parametrize("table", ["3", "4"])
def test_mbpoll_reads_every_register_in_both_address_styles(
    first: int, zero_based: bool, table: str, line: ModbusLine
) -> None:
    options = ["-t", f"{table}:hex", "-a", "1", *(["-0"] if zero_based else [])]
    code, said = mbpoll(line, *options, "-r", str(STATUS_START + first), "-c", str(STATUS_WORDS), "127.0.0.1")
    assert code == 0, said
    read = values(said)
    assert sorted(read) == list(range(STATUS_START + first, STATUS_START + first + STATUS_WORDS))
    assert [read[168 + first + i] for i in range(4)] == [0x1234, 0x5678, 0x42F6, 0xE979]
    code, said = mbpoll(line, *options, "-r", str(first), "-c", str(COMMAND_WORDS), "127.0.0.1")
    assert sorted(values(said)) == list(range(first, first + COMMAND_WORDS))


@pytest.mark.parametrize("register", [r for r in MAP if r.address < COMMAND_WORDS], ids=lambda r: r.name)
def test_mbpoll_writes_every_command_register(register: object, line: ModbusLine) -> None:
    address, words = register.address, register.words  # type: ignore[attr-defined]
    for first, style in ((0, ["-0"]), (1, [])):
        sent = [str(16 + first + i) for i in range(words)]
        code, said = mbpoll(line, "-t", "4", *style, "-r", str(address + first), "127.0.0.1", *sent)
        assert code == 0, said
        _, said = mbpoll(
            line, "-t", "4:hex", *style, "-r", str(address + first), "-c", str(words), "127.0.0.1"
        )
        assert [str(word) for _, word in sorted(values(said).items())] == sent


@pytest.mark.parametrize("unit", ["0", "1", "255"])
def test_mbpoll_reads_bits_at_every_unit(unit: str, line: ModbusLine) -> None:
    for table in ("0", "1"):
        code, said = mbpoll(
            line, "-t", table, "-a", unit, "-0", "-r", str(STATUS_START * 16), "-c", "16", "127.0.0.1"
        )
        assert code == 0, said
        assert len(re.findall(r"\[\d+\]:\s+[01]", said)) == 16


def test_mbpoll_is_refused_where_only_the_station_writes(line: ModbusLine) -> None:
    for register in MAP:
        if register.address >= STATUS_START:
            code, said = mbpoll(line, "-t", "4", "-0", "-r", str(register.address), "127.0.0.1", "1")
            assert code != 0
            assert "Illegal data address" in said


def peer(folder: Path) -> Path:
    """The PLC in C, built."""
    sizes = [f"-DSTATUS_START={STATUS_START}", f"-DSTATUS_WORDS={STATUS_WORDS}"]
    build = ["gcc", "-O1", "-Wall", "-Werror", "-I/usr/include/modbus", *sizes, str(HERE / "peer.c")]
    subprocess.run([*build, "-o", str(folder / "peer"), "-lmodbus"], check=True, timeout=600)
    return folder / "peer"


def test_a_plc_works_beside_readers_that_poll_in_parallel(line: ModbusLine, tmp_path: Path) -> None:
    """A libmodbus PLC, two mbpolls without an end, and a client that sends 60 requests at once."""
    program = peer(tmp_path)
    poll = [
        "mbpoll",
        "-1",
        "-p",
        str(line.port),
        "-t",
        "4:hex",
        "-r",
        "101",
        "-c",
        str(STATUS_WORDS),
        "-l",
        "10",
    ]
    readers = [
        subprocess.Popen([*poll, "127.0.0.1"], stdout=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True)
        for _ in range(2)
    ]
    stop, bursts = threading.Event(), []

    def shout() -> None:
        while not stop.is_set():
            asyncio.run(RemoteWindows.at("127.0.0.1", line.port).burst())
            bursts.append(1)
            stop.wait(0.02)

    shouting = threading.Thread(target=shout)
    shouting.start()
    try:
        with Judge(line, lambda trigger: judged(trigger, VerdictCode.OK)):
            done = subprocess.run(
                [program, str(line.port), "300"], capture_output=True, text=True, timeout=600, check=False
            )
    finally:
        stop.set()
        shouting.join()
        for reader in readers:
            reader.terminate()
        said = [reader.communicate(timeout=60)[0] for reader in readers]
    assert done.stdout.split() == ["300", "300", "0", "0"], done.stdout + done.stderr
    assert len(bursts) > 3
    for text in said:
        assert "failed" not in text
        assert len(values(text)) == STATUS_WORDS


def test_a_libmodbus_plc_does_the_whole_handshake_a_thousand_times(line: ModbusLine, tmp_path: Path) -> None:
    program = peer(tmp_path)
    seen: list[int] = []

    def decide(trigger: Trigger) -> Result:
        seen.append(trigger.trigger_id)
        verdict = VerdictCode.OK if trigger.trigger_id % 3 else VerdictCode.NOK
        return judged(trigger, verdict)

    with Judge(line, decide):
        done = subprocess.run(
            [program, str(line.port), "1000"],
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
    assert done.stdout.split() == ["1000", "667", "333", "0"], done.stdout + done.stderr
    assert seen == list(range(1, 1001))

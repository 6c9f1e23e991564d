"""A grab that never returns: ERROR at the deadline, a new process, and a record of the part."""

import asyncio
import os
import subprocess
import sys
from pathlib import Path

import pytest

from deploy.demo.ports import free_ports
from deploy.demo.station import station_toml
from station.archive.reader import read_records
from station.domain import Verdict
from station.engine.recording import INTERRUPTED
from station.engine.watchdog import HUNG
from station.plc.map.registers import VerdictCode
from station.plc.simulated.line import Answer, SimulatedLine
from station.records import Record
from synth.camera.feed import Feed

ENGINE = """
import ctypes, sys
from pathlib import Path
from station.camera.pylon import PylonCamera
from station.engine import cycle, startup

def grab(self, trigger_s):
    mutex = ctypes.create_string_buffer(64)
    for _ in range(2):
        ctypes.CDLL(None).pthread_mutex_lock(mutex)

if sys.argv[2] == "hangs":
    PylonCamera.grab = grab
cycle.PART_GRACE_S = float(sys.argv[3])
startup.run_engine(Path(sys.argv[1]))
"""


class Station:
    """An engine whose camera hangs, or works."""

    def __init__(self, folder: Path, deadline_ms: int) -> None:
        self.port, self.records = free_ports(1)[0], folder / "records"
        self._feed, self._settings = Feed(folder / "feed"), folder / "station.toml"
        self._settings.write_text(station_toml(self.records, self.port, deadline_ms=deadline_ms))

    def start(self, how: str, grace_s: float = 1.0) -> subprocess.Popen[bytes]:
        environment = {**os.environ, **self._feed.environment, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-c", ENGINE, str(self._settings), how, str(grace_s)]
        return subprocess.Popen(command, env=environment)

    async def inspect(self, *serials: str) -> list[Answer]:
        line = SimulatedLine.at("127.0.0.1", self.port, accept_simulated=True)
        await line.connect()
        try:
            return [await line.inspect(serial, 60.0) for serial in serials]
        finally:
            await line.close()

    def records_after_a_start(self, count: int) -> list[Record]:
        engine = self.start("works")
        records: list[Record] = []
        try:
            for _ in range(300):
                found = [entry.record for entry in read_records(self.records)]
                records = [record for record in found if record is not None]
                if len(records) >= count:
                    break
                with pytest.raises(subprocess.TimeoutExpired):
                    engine.wait(timeout=0.2)
        finally:
            engine.terminate()
            assert engine.wait(timeout=60) == 0
        return records


def test_a_grab_that_never_returns_ends_in_error_a_record_and_a_new_start(tmp_path: Path) -> None:
    station = Station(tmp_path, deadline_ms=3000)
    engine = station.start("hangs")
    try:
        (answer,) = asyncio.run(station.inspect("CELL-7"))
        assert (answer.verdict, answer.accepted) == (VerdictCode.ERROR, False)
        assert engine.wait(timeout=60) == HUNG
    finally:
        engine.kill()
        engine.wait()
    records = station.records_after_a_start(1)
    assert [record.serial for record in records] == ["CELL-7"]
    assert (records[0].verdict, records[0].inspection.detail) == (Verdict.ERROR, INTERRUPTED)


@pytest.mark.parametrize("end", ["watchdog", "signal"])
def test_a_part_that_begins_while_another_hangs_gets_its_record_too(tmp_path: Path, end: str) -> None:
    """With a short deadline the PLC gets its ERROR, and may begin the next part, before READY falls."""
    station = Station(tmp_path, deadline_ms=1000)
    engine = station.start("hangs", grace_s=1.0 if end == "watchdog" else 1000.0)
    try:
        answers = asyncio.run(station.inspect("CELL-7", "CELL-8"))
        assert not any(answer.accepted for answer in answers)
        if end == "signal":
            engine.terminate()
        assert engine.wait(timeout=60) == HUNG
    finally:
        engine.kill()
        engine.wait()
    records = station.records_after_a_start(2)
    assert [record.serial for record in records] == ["CELL-7", "CELL-8"]
    assert {(record.verdict, record.inspection.detail) for record in records} == {
        (Verdict.ERROR, INTERRUPTED)
    }

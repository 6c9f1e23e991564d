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
from synth.camera.feed import Feed

ENGINE = """
import ctypes, sys
from pathlib import Path
from station.camera.pylon import PylonCamera
from station.engine import startup

def grab(self, trigger_s):
    mutex = ctypes.create_string_buffer(64)
    for _ in range(2):
        ctypes.CDLL(None).pthread_mutex_lock(mutex)

if sys.argv[2] == "hangs":
    PylonCamera.grab = grab
startup.PART_GRACE_S = 1.0
startup.run_engine(Path(sys.argv[1]))
"""


def test_a_grab_that_never_returns_ends_in_error_a_record_and_a_new_start(tmp_path: Path) -> None:
    feed, port = Feed(tmp_path / "feed"), free_ports(1)[0]
    settings = tmp_path / "station.toml"
    settings.write_text(station_toml(tmp_path / "records", port, deadline_ms=3000))

    def start(how: str) -> subprocess.Popen[bytes]:
        environment = {**os.environ, **feed.environment, "PYTHONPATH": os.pathsep.join(sys.path)}
        return subprocess.Popen([sys.executable, "-c", ENGINE, str(settings), how], env=environment)

    async def inspect() -> Answer:
        line = SimulatedLine.at("127.0.0.1", port, accept_simulated=True)
        await line.connect()
        try:
            return await line.inspect("CELL-7", 60.0)
        finally:
            await line.close()

    engine = start("hangs")
    try:
        answer = asyncio.run(inspect())
        assert (answer.verdict, answer.accepted) == (VerdictCode.ERROR, False)
        assert engine.wait(timeout=60) == HUNG
    finally:
        engine.kill()
        engine.wait()
    engine = start("works")
    try:
        for _ in range(300):
            records = [entry.record for entry in read_records(tmp_path / "records")]
            if records:
                break
            with pytest.raises(subprocess.TimeoutExpired):
                engine.wait(timeout=0.2)
    finally:
        engine.terminate()
        assert engine.wait(timeout=60) == 0
    assert [record.serial for record in records if record is not None] == ["CELL-7"]
    assert records[0] is not None
    assert (records[0].verdict, records[0].inspection.detail) == (Verdict.ERROR, INTERRUPTED)

"""What hangs ends the engine, SIGTERM always ends it, and the part in progress gets its record."""

import os
import signal
import socket
import subprocess
import sys
import threading
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.archive.in_progress import NAME
from station.archive.reader import read_records
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import Inspection, Origin, Purpose, Verdict
from station.engine.check_ins import CheckIns
from station.engine.recording import INTERRUPTED, record_interrupted
from station.engine.watchdog import HUNG, Watchdog
from station.records import Part
from station.settings.model import ArchiveSettings
from tests.parts import provenance

PART = Part("CELL-7", 7, Origin.CAMERA)
NAMES = st.sampled_from(["cycle", "plc", "alarms"])
STEPS = st.lists(st.tuples(NAMES, st.sampled_from(["expect", "rest", "wait"]), st.floats(0.1, 9)))


@given(STEPS)
def test_a_thread_is_overdue_once_its_time_is_over_and_only_then(steps: list[tuple[str, str, float]]) -> None:
    now = [0.0]
    check_ins, due = CheckIns(lambda: now[0]), dict[str, float]()
    for name, what, seconds in steps:
        if what == "wait":
            now[0] += seconds
        elif what == "expect":
            check_ins.expect(name, seconds)
            due[name] = now[0] + seconds
        else:
            check_ins.rest(name)
            due.pop(name, None)
        assert check_ins.overdue() == {each: now[0] - at for each, at in due.items() if now[0] > at}


def test_work_that_fails_is_over_too() -> None:
    check_ins = CheckIns(lambda: 0.0)

    def fail() -> None:
        with check_ins.working("alarms", -1.0):
            assert list(check_ins.overdue()) == ["alarms"]
            raise ValueError("disk")

    with pytest.raises(ValueError, match="disk"):
        fail()
    assert not check_ins.overdue()


def test_the_service_manager_hears_of_life_until_a_thread_hangs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    ended, check_ins = threading.Event(), CheckIns()
    why: list[str] = []

    def end(text: str, _steps: object) -> None:
        why.append(text)
        ended.set()

    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(tmp_path / "notify"))
        manager.settimeout(10)
        monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "notify"))
        check_ins.expect("cycle", 100)
        with closing(Watchdog(check_ins, end=end, tick_s=0.02)):
            assert manager.recv(100) == b"READY=1"
            assert manager.recv(100) == b"WATCHDOG=1"
            check_ins.expect("cycle", 0.05)
            assert ended.wait(10)
    assert why[0].startswith("no sign of life: cycle (0.")


HANGS = """
import ctypes, sys, threading, time
from pathlib import Path
from station.engine.check_ins import CheckIns
from station.engine.watchdog import StopSignals, Watchdog

def last_steps():
    Path(sys.argv[1]).write_text("done")
    {last}

def hang():
    print("ready", flush=True)
    mutex = ctypes.create_string_buffer(64)
    for _ in range(2):  # the second time it waits for itself; no signal ends that
        ctypes.CDLL(None).pthread_mutex_lock(mutex)

stop, check_ins = threading.Event(), CheckIns()
with StopSignals(stop, last_steps, within_s=0.5):
    check_ins.expect("cycle", {limit})
    dog = Watchdog(check_ins, last_steps, tick_s=0.05)
    {what}
    dog.close()
"""
"""An engine whose main thread hangs in C, as in a camera driver."""


def start(tmp_path: Path, *, what: str, limit: float, last: str = "") -> subprocess.Popen[str]:
    code = HANGS.format(what=what, limit=limit, last=last or "pass")
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path / "last")],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    return process


@pytest.mark.parametrize("last", ["", "time.sleep(1000)", "raise OSError('disk full')"])
def test_an_engine_that_hangs_in_a_driver_ends_itself(tmp_path: Path, last: str) -> None:
    process = start(tmp_path, what="hang()", limit=0.3, last=last)
    _out, errors = process.communicate(timeout=60)
    assert process.returncode == HUNG
    assert (tmp_path / "last").read_text() == "done"
    assert "no sign of life: cycle" in errors
    assert "in hang" in errors


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_an_engine_that_hangs_in_a_driver(tmp_path: Path, number: int) -> None:
    process = start(tmp_path, what="hang()", limit=1000)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    process.send_signal(number)
    _out, errors = process.communicate(timeout=60)
    assert process.returncode == HUNG
    assert "not stopped within 0.5 s after a signal" in errors
    assert (tmp_path / "last").exists()


def test_a_signal_stops_an_engine_that_works_in_peace(tmp_path: Path) -> None:
    what = "print('ready', flush=True); stop.wait(); print('stopped')"
    process = start(tmp_path, what=what, limit=1000)
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    process.send_signal(signal.SIGTERM)
    out, errors = process.communicate(timeout=60)
    assert (process.returncode, out, errors) == (0, "stopped\n", "")
    assert not (tmp_path / "last").exists()


# The part in progress


def opened(folder: Path) -> Archive:
    return Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))


def commit(archive: Archive, serial: str) -> None:
    inspection, part = Inspection.error(Reason.NO_FRAME), Part(serial, 1, Origin.CAMERA)
    archive.commit(archive.begin(None), inspection, part, provenance(), now=datetime.now(UTC))


@pytest.mark.parametrize("purpose", [Purpose.PART, Purpose.GOLDEN])
def test_a_part_during_which_the_engine_ended_is_recorded_as_error_once(
    tmp_path: Path, purpose: Purpose
) -> None:
    part = Part("CELL-7", 7, Origin.CAMERA, purpose)
    with closing(opened(tmp_path)) as archive:
        commit(archive, "before")
        archive.announce(part)
    for _ in range(2):
        with closing(opened(tmp_path)) as archive:
            record_interrupted(archive, provenance())
    records = [entry.record for entry in read_records(tmp_path)]
    assert [record.serial for record in records if record is not None] == ["before", "CELL-7"]
    assert records[1] is not None
    found = records[1].inspection
    assert (found.verdict, found.reason, found.detail) == (Verdict.ERROR, Reason.INTERNAL, INTERRUPTED)
    assert (records[1].trigger_id, records[1].purpose) == (7, purpose)


@pytest.mark.parametrize("recorded", [0, 1, 2])
def test_a_part_that_waits_for_a_hanging_one_is_recorded_too(tmp_path: Path, recorded: int) -> None:
    """The first is answered at its deadline, so that the PLC may begin the next while the cycle hangs."""
    with closing(opened(tmp_path)) as archive:
        commit(archive, "before")
        archive.announce(Part("CELL-7", 7, Origin.CAMERA))
        archive.announce(Part("CELL-8", 8, Origin.CAMERA), waits=True)
        for serial in ("CELL-7", "CELL-8")[:recorded]:
            commit(archive, serial)
        assert (tmp_path / NAME).exists() == (recorded < 2)
    for _ in range(2):
        with closing(opened(tmp_path)) as archive:
            record_interrupted(archive, provenance())
    serials = [entry.record.serial for entry in read_records(tmp_path) if entry.record is not None]
    assert serials == ["before", "CELL-7", "CELL-8"]


def test_a_part_with_a_record_is_not_recorded_again(tmp_path: Path) -> None:
    with closing(opened(tmp_path)) as archive:
        archive.announce(PART)
        announced = (tmp_path / NAME).read_bytes()
        commit(archive, "CELL-7")
        assert not (tmp_path / NAME).exists()
        (tmp_path / NAME).write_bytes(announced)  # the engine ended between the record and this file
    with closing(opened(tmp_path)) as archive:
        assert archive.interrupted == ()


@pytest.mark.parametrize("content", [b"", b"{}", b"[1]", b"\x00\xff", b'{"part": 1, "inspection_id": 1e9}'])
def test_a_damaged_note_stops_nothing(tmp_path: Path, content: bytes) -> None:
    (tmp_path / NAME).write_bytes(content)
    with closing(opened(tmp_path)) as archive:
        assert archive.interrupted == ()


def test_a_part_can_be_noted_from_another_thread(tmp_path: Path) -> None:
    with closing(opened(tmp_path)) as archive:
        commit(archive, "before")
        thread = threading.Thread(target=archive.announce, args=(PART,))
        thread.start()
        thread.join()
    with closing(opened(tmp_path)) as archive:
        assert archive.interrupted == (PART,)

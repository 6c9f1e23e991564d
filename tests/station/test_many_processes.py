"""Processes that use one database at once: each gets its turn, on a slow disk too, and none is refused."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from station.archive.reader import find
from station.files.lock import turn
from station.journal.journal import entries, verify_journal
from tests.conftest import ROOT

WRITER = """
import sys, time
from pathlib import Path
import station.journal.journal_writer as journal_writer
from station.journal.journal import Kind
folder, name, count, hold_s = Path(sys.argv[1]), sys.argv[2], int(sys.argv[3]), float(sys.argv[4])
real = journal_writer.link_entry
def slow(*values):
    time.sleep(hold_s)  # a slow disk: the file is in use all the time but for moments
    return real(*values)
journal_writer.link_entry = slow
print("ready", flush=True)
sys.stdin.readline()
for number in range(count):
    journal_writer.append(folder, Kind.ALARM, name, str(number))
"""
READER = """
import sys
from pathlib import Path
from station.journal.journal import entries, verify_journal
folder, count = Path(sys.argv[1]), int(sys.argv[3])
print("ready", flush=True)
sys.stdin.readline()
seen = 0
for _ in range(count):
    assert list(verify_journal(folder)) == []
    before, seen = seen, len(entries(folder))
    assert seen >= before
"""
OPENER = """
import sys
from pathlib import Path
from station.archive.schema import open_index
from station.archive.reader import find
folder, count = Path(sys.argv[1]), int(sys.argv[3])
print("ready", flush=True)
sys.stdin.readline()
for _ in range(count):
    open_index(folder).close()
    assert find(folder) == []
"""


def run_together(folder: Path, programs: list[str], *, count: int, hold_s: float = 0.0) -> list[str]:
    """Run programs at once and return the last line of each that failed."""
    started = [
        subprocess.Popen(
            [sys.executable, "-c", code, str(folder), f"p{number}", str(count), str(hold_s)],
            cwd=ROOT,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for number, code in enumerate(programs)
    ]
    try:
        for process in started:
            assert process.stdout is not None
            assert process.stdout.readline() == "ready\n"
        for process in started:
            assert process.stdin is not None
            process.stdin.write("go\n")
            process.stdin.flush()
        ends = [process.communicate(timeout=600)[1].strip() for process in started]
    finally:
        for process in started:
            process.kill()
            process.communicate()
    return [
        end.splitlines()[-1] for end, process in zip(ends, started, strict=True) if process.returncode != 0
    ]


def test_writers_of_a_slow_journal_take_turns(tmp_path: Path) -> None:
    assert run_together(tmp_path, [WRITER] * 10 + [READER] * 2, count=12, hold_s=0.1) == []
    assert len(entries(tmp_path)) == 120
    assert list(verify_journal(tmp_path)) == []


def test_many_writers_and_readers_of_a_quick_journal(tmp_path: Path) -> None:
    assert run_together(tmp_path, [WRITER, WRITER, READER] * 8, count=20) == []
    assert len(entries(tmp_path)) == 16 * 20
    assert list(verify_journal(tmp_path)) == []


def test_an_index_that_many_open_is_made_once(tmp_path: Path) -> None:
    assert run_together(tmp_path, [OPENER] * 12, count=10) == []
    assert find(tmp_path) == []


def test_who_waits_for_a_turn_gets_it_and_who_waits_too_long_is_refused(tmp_path: Path) -> None:
    order: list[int] = []

    def take(number: int) -> None:
        with turn(tmp_path / "lock", 60.0):
            order.append(number)

    waiting = [threading.Thread(target=take, args=(number,)) for number in range(4)]
    with turn(tmp_path / "lock", 60.0):
        for thread in waiting:
            thread.start()
        with pytest.raises(BlockingIOError, match="another process"), turn(tmp_path / "lock", 0.05):
            raise AssertionError
        assert order == []
    for thread in waiting:
        thread.join(timeout=60)
    assert sorted(order) == [0, 1, 2, 3]
    # a process that another thread is just starting holds a copy of the lock until it runs its program
    with turn(tmp_path / "lock", 60.0):
        pass

"""One process at a time: a lock held elsewhere refuses at once, a killed holder leaves only a file."""

import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from station.archive.writer import Archive
from station.errors import RecordError
from station.files.lock import hold, turn
from station.settings.model import ArchiveSettings
from tests.conftest import ROOT


@pytest.mark.parametrize("before", [None, 0o644, 0o664, 0o666])
def test_who_may_not_write_a_lock_file_cannot_hold_its_lock(tmp_path: Path, before: int | None) -> None:
    """To read a file is enough to lock it: any account stalled the journal and the index."""
    for name in ("turn.lock", "hold.lock"):
        path = tmp_path / name
        if before is not None:
            path.touch()
            path.chmod(before)
        if name == "turn.lock":
            with turn(path, 1.0):
                mode = path.stat().st_mode & 0o777
        else:
            hold(path).release()
            mode = path.stat().st_mode & 0o777
        assert mode == (0o660 if before in (0o664, 0o666) else 0o600)


HOLDER = """
import sys
from pathlib import Path
from station.files.lock import hold, turn
lock = hold(Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.read()
lock.release()
"""


@contextmanager
def held_elsewhere(path: Path) -> Iterator["subprocess.Popen[str]"]:
    """Another process that holds the lock until its input ends."""
    command = [sys.executable, "-c", HOLDER, str(path)]
    with subprocess.Popen(
        command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "held\n"
        try:
            yield process
        finally:
            process.kill()


def test_a_lock_held_by_another_process_is_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "x.lock"
    with held_elsewhere(path) as process:
        begin = time.monotonic()
        with pytest.raises(BlockingIOError, match="held by another process"):
            hold(path)
        assert time.monotonic() - begin < 1.0
        process.communicate("", timeout=200)
        hold(path).release()


def test_a_killed_holder_leaves_a_file_and_no_lock(tmp_path: Path) -> None:
    path = tmp_path / "x.lock"
    with held_elsewhere(path) as process:
        process.send_signal(signal.SIGKILL)
        process.wait(timeout=200)
    assert path.exists()
    hold(path).release()


def test_the_same_process_cannot_take_a_lock_twice(tmp_path: Path) -> None:
    lock = hold(tmp_path / "x.lock")
    with pytest.raises(BlockingIOError):
        hold(tmp_path / "x.lock")
    lock.release()
    hold(tmp_path / "x.lock").release()


def test_a_lock_may_be_released_by_another_thread(tmp_path: Path) -> None:
    lock = hold(tmp_path / "x.lock")
    other = threading.Thread(target=lock.release)
    other.start()
    other.join()
    hold(tmp_path / "x.lock").release()


def test_an_archive_in_use_is_refused_until_its_engine_is_gone(tmp_path: Path) -> None:
    settings = ArchiveSettings(folder=tmp_path, min_free_mb=1, thin_free_mb=1, warn_free_mb=1)
    with held_elsewhere(tmp_path / "engine.lock"):
        with pytest.raises(RecordError) as caught:
            Archive(settings)
        assert (
            str(caught.value)
            == f"{tmp_path}: another engine writes its records here; stop it, or set archive.folder"
        )
    Archive(settings).close()

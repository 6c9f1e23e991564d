"""A named output is what it was: devices, FIFOs and links stay, mode and owner are kept."""

import json
import os
import stat
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from deploy.demo.summary import write_json as write_summary
from station.__main__ import main
from station.analysis.export import export
from station.classify.drift import Reference, write_reference
from station.domain import Verdict
from station.engine.settings_change import stage_changes
from station.files.destination import output_path
from station.files.durable import replacing, write_whole
from station.replay.replayed import Replayed
from station.replay.results import write_csv, write_json
from synth.output.storage import write_text
from tests.conftest import ROOT
from tests.parts import FRAMES, label_with

RESULT = Replayed(name="a.png", verdict=Verdict.ERROR, reason="no ring")
REFERENCE = Reference(model_hash="x", parts=1, mean=(0.0,), spread=(1.0,), limit=1.0)


def _export(form: str) -> Callable[[Path], object]:
    return lambda path: list(export([], path.parent, path, form))


def _written_to(path: Path) -> None:
    with replacing(path) as part:
        part.write_bytes(b"x")


WRITERS: dict[str, Callable[[Path], object]] = {
    "replay --json": lambda path: write_json(path, [RESULT]),
    "replay --csv": lambda path: write_csv(path, [RESULT]),
    "records export csv": _export("csv"),
    "records export json": _export("json"),
    "records export dfq": _export("dfq"),
    "first-day --reference": lambda path: write_reference(path, REFERENCE),
    "demo --json": lambda path: write_summary(path, [], path.parent),
    "calibrate --out": lambda path: write_text(path, "[surface]\n"),
    "whole": lambda path: write_whole(path, b"x"),
    "durable": lambda path: write_whole(path, b"x", durable=True),
    "replacing": _written_to,
}
KEPT = {name: write for name, write in WRITERS.items() if not name.startswith("records export")}
"""Writers that replace a file; an export refuses one."""


def of_all(writers: dict[str, Callable[[Path], object]]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("write", writers.values(), ids=writers.keys())


@of_all(WRITERS)
def test_a_device_is_written_to_and_stays(tmp_path: Path, write: Callable[[Path], object]) -> None:
    here, there = os.openpty()
    device = Path(os.ttyname(there))
    before, got = device.stat(), bytearray()

    def read() -> None:
        try:
            while data := os.read(here, 65536):
                got.extend(data)
        except OSError:  # the other end is closed
            return

    reader = threading.Thread(target=read)
    reader.start()
    (tmp_path / "link").symlink_to(device)
    try:
        write(tmp_path / "link")
        after = device.stat()
    finally:
        os.close(there)
        reader.join(timeout=60)
        os.close(here)
    assert stat.S_ISCHR(after.st_mode)
    assert (after.st_ino, after.st_rdev) == (before.st_ino, before.st_rdev)
    assert (tmp_path / "link").is_symlink()
    assert got
    assert [entry.name for entry in tmp_path.iterdir()] == ["link"]


@of_all(WRITERS)
def test_a_fifo_is_written_to_and_stays(tmp_path: Path, write: Callable[[Path], object]) -> None:
    fifo, got = tmp_path / "fifo", []
    os.mkfifo(fifo)
    reader = threading.Thread(target=lambda: got.append(fifo.read_bytes()), daemon=True)
    reader.start()
    write(fifo)
    reader.join(timeout=60)
    assert got
    assert got[0]
    assert stat.S_ISFIFO(fifo.stat().st_mode)
    assert [entry.name for entry in tmp_path.iterdir()] == ["fifo"]


@of_all(KEPT)
def test_links_are_followed_and_the_mode_is_kept(tmp_path: Path, write: Callable[[Path], object]) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "near").mkdir()
    real = tmp_path / "far" / "real"
    real.write_text("old")
    real.chmod(0o640)
    (tmp_path / "near" / "second").symlink_to("../far/real")
    (tmp_path / "near" / "first").symlink_to("second")
    write(tmp_path / "near" / "first")
    assert (tmp_path / "near" / "first").is_symlink()
    assert (tmp_path / "near" / "second").is_symlink()
    assert real.read_bytes() != b"old"
    assert stat.S_IMODE(real.stat().st_mode) == 0o640
    assert [entry.name for entry in real.parent.iterdir()] == ["real"]


@of_all(WRITERS)
def test_a_link_to_nothing_makes_the_file_it_names(tmp_path: Path, write: Callable[[Path], object]) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "made")
    write(tmp_path / "link")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "made").stat().st_size


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root can give a file away")
def test_the_owner_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "x.json"
    path.write_text("old")
    os.chown(path, 12345, 23456)
    write_whole(path, b"new")
    assert path.read_bytes() == b"new"
    assert (path.stat().st_uid, path.stat().st_gid) == (12345, 23456)


AS_ANOTHER = """
import os, sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from station.files.durable import write_whole
os.setgid(23456); os.setgroups([]); os.setuid(12345)
write_whole(Path(sys.argv[1]), b"new")
"""


@pytest.mark.skipif(os.name != "posix" or os.geteuid() != 0, reason="only root can become another user")
def test_a_file_of_another_owner_or_in_a_closed_folder_is_written_in_place(tmp_path: Path) -> None:
    for name, mode in (("open", 0o777), ("closed", 0o755)):
        folder = Path("/tmp") / f"{tmp_path.name}-{os.getpid()}-{name}"
        folder.mkdir()
        path = folder / "x"
        try:
            folder.chmod(mode)
            path.write_text("older and longer")
            path.chmod(0o666)
            done = subprocess.run(
                [sys.executable, "-c", AS_ANOTHER, str(path), str(ROOT)],
                capture_output=True,
                text=True,
                check=False,
                timeout=600,
            )
            assert done.returncode == 0, done.stderr
            assert path.read_bytes() == b"new"
            assert path.stat().st_uid == 0
        finally:
            path.unlink(missing_ok=True)
            folder.rmdir()


def test_a_loop_of_links_and_a_folder_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    with pytest.raises(OSError, match="links"):
        write_whole(tmp_path / "a", b"x")
    with pytest.raises(IsADirectoryError):
        write_whole(tmp_path, b"x")


def test_changes_of_the_settings_follow_a_link(tmp_path: Path) -> None:
    (tmp_path / "far.json").write_text("{}")
    (tmp_path / "far.json").chmod(0o600)
    (tmp_path / "station.adjusted.json").symlink_to("far.json")
    _, replace_file = stage_changes(tmp_path / "station.toml", {"camera": {}})
    replace_file()
    assert (tmp_path / "station.adjusted.json").is_symlink()
    assert json.loads((tmp_path / "far.json").read_text()) == {"camera": {}}
    assert stat.S_IMODE((tmp_path / "far.json").stat().st_mode) == 0o600


def weldgate(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-m", "station", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


@pytest.mark.parametrize("name", ["-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"])
def test_results_on_standard_output_are_alone_there(name: str) -> None:
    frame = str(FRAMES / label_with("OK")["frame"])
    done = weldgate("replay", frame, "--json", name, "--processes", "1")
    assert done.returncode == 0, done.stderr
    assert list(json.loads(done.stdout)) == [Path(frame).name]
    assert "1 images: 1 OK" in done.stderr


def test_results_appended_to_a_file_keep_what_it_holds(tmp_path: Path) -> None:
    frame, log = str(FRAMES / label_with("OK")["frame"]), tmp_path / "log"
    log.write_text("first line\n")
    with log.open("a") as file:
        command = [sys.executable, "-m", "station", "replay", frame, "--csv", "-", "--processes", "1"]
        subprocess.run(command, cwd=ROOT, stdout=file, check=True, timeout=600)
    lines = log.read_text().splitlines()
    assert lines[0] == "first line"
    assert lines[1].startswith("file,verdict")


def test_two_results_need_two_outputs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    frame = str(FRAMES / label_with("OK")["frame"])
    (tmp_path / "link").symlink_to(tmp_path / "x")
    for json_name, csv_name in (("-", "/dev/stdout"), (str(tmp_path / "x"), str(tmp_path / "link"))):
        assert main(["replay", frame, "--json", json_name, "--csv", csv_name]) == 2
        assert "same output" in capsys.readouterr().err


def test_a_dash_is_standard_output() -> None:
    assert output_path("-") == Path("/dev/stdout")
    assert output_path("./-") == Path("-")

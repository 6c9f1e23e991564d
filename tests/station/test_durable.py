"""A file is seen whole or not at all: while it is written, after an error, after a kill."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deploy.demo.summary import write_json as write_summary
from station.analysis import export
from station.classify.drift import Reference, write_reference
from station.domain import Verdict
from station.files.durable import replacing, write_whole
from station.replay.replayed import Replayed
from station.replay.results import write_csv
from synth.errors import SynthError
from synth.output.storage import write_bytes
from tests.conftest import ROOT

HALF = """
import os, signal, sys
from pathlib import Path
from station.files.durable import replacing
with replacing(Path(sys.argv[1])) as part:
    part.write_bytes(b"half of it")
    os.kill(os.getpid(), signal.SIGKILL)
"""


def names(folder: Path) -> list[str]:
    return [entry.name for entry in folder.iterdir()]


def _half(target: Path) -> None:
    target.write_text("half of it")
    raise OSError(28, "No space left on device")


Folders = pytest.TempPathFactory


@given(st.binary(), st.binary(), st.booleans())
def test_what_was_written_last_is_there_alone(
    tmp_path_factory: Folders, old: bytes, new: bytes, durable: bool
) -> None:
    path = tmp_path_factory.mktemp("d") / "x.json"
    for data in (old, new):
        write_whole(path, data, durable=durable)
    assert path.read_bytes() == new
    assert names(path.parent) == ["x.json"]


def test_durable_is_on_disk_before_it_has_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    synced: list[bool] = []
    real = os.fsync

    def fsync(handle: int) -> None:
        synced.append((tmp_path / "x").exists())
        real(handle)

    monkeypatch.setattr(os, "fsync", fsync)
    write_whole(tmp_path / "x", b"1")
    assert synced == []
    (tmp_path / "x").unlink()
    write_whole(tmp_path / "x", b"1", durable=True)
    assert synced == [False]


def test_an_error_leaves_the_old_file_and_nothing_else(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text("old")
    with pytest.raises(OSError, match="No space"), replacing(path) as part:
        _half(part)
    assert path.read_text() == "old"
    assert names(tmp_path) == ["x.csv"]


def test_a_kill_leaves_the_old_file_and_the_next_write_clears_the_rest(tmp_path: Path) -> None:
    path = tmp_path / "x.csv"
    path.write_text("old")
    done = subprocess.run([sys.executable, "-c", HALF, str(path)], cwd=ROOT, check=False, timeout=600)
    assert done.returncode == -signal.SIGKILL
    assert path.read_text() == "old"
    write_whole(path, b"new")
    assert path.read_text() == "new"
    assert names(tmp_path) == ["x.csv"]


def test_an_export_that_fails_leaves_no_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export, "_csv", lambda target, entries: _half(target))
    with pytest.raises(OSError, match="No space"):
        list(export.export([], tmp_path, tmp_path / "out.csv", "csv"))
    assert names(tmp_path) == []


def test_every_room_writes_whole_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def torn(part: Path, path: Path) -> None:
        raise OSError(5, "Input/output error", str(part))

    monkeypatch.setattr(Path, "replace", torn)
    result = Replayed(name="a.png", verdict=Verdict.ERROR, reason="no ring")
    with pytest.raises(OSError, match="Input/output"):
        write_csv(tmp_path / "r.csv", [result])
    with pytest.raises(OSError, match="Input/output"):
        write_reference(
            tmp_path / "reference.json",
            Reference(model_hash="x", parts=1, mean=(0.0,), spread=(1.0,), limit=1.0),
        )
    with pytest.raises(OSError, match="Input/output"):
        write_summary(tmp_path / "demo.json", [], tmp_path)
    with pytest.raises(SynthError, match=r"manifest\.json: could not be written: Input/output error"):
        write_bytes(tmp_path / "manifest.json", json.dumps({}).encode())
    assert names(tmp_path) == []

"""No byte of an index, a journal, a bus log or a record ends a command with a traceback."""

import hashlib
import json
import os
import random
import shutil
import sqlite3
from collections.abc import Callable
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from station.__main__ import main
from station.archive.writer import Archive
from station.domain import Frame, Origin
from station.engine.retention import prune_archive
from station.files.regular import read_regular
from station.journal.accounts import Accounts
from station.journal.journal import Kind
from station.journal.journal_writer import append
from station.journal.users import Level
from station.records import Part
from station.settings.model import ArchiveSettings, KeepSettings
from tests.parts import nok_inspection, ok_inspection, provenance

NOW = datetime(2026, 11, 22, 12, tzinfo=UTC)
COMMANDS = (("verify",), ("list",), ("export",), ("bus",), ("clock",), ("report",))
ROOMY = {"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 1}


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("whole") / "a"
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    for number in range(4):
        frame = Frame(np.zeros((16, 16), np.uint8), NOW, "cam", Origin.SIMULATED)
        found = nok_inspection() if number % 2 else ok_inspection()
        part = Part(f"P{number}", number + 1, Origin.SIMULATED)
        archive.commit(archive.begin(frame), found, part, provenance(), now=NOW)
    archive.close()
    accounts = Accounts(folder, folder.parent / "keys")
    accounts.save_user("Ada", level=Level.ADMIN, pin="123456", by="Ada")
    append(folder, Kind.REVIEW, "Ada", "2", before="NOK", after="right")
    edge = (
        '{"time": "2026-11-22T12:00:00.000+00:00", "by": "PLC", "name": "TRIGGER", "value": 1, "note": ""}\n'
    )
    (folder / "bus-2026-11-22.jsonl").write_text(edge * 5)
    for name in ("index", "journal"):
        with closing(sqlite3.connect(folder / f"{name}.sqlite")) as connection:
            connection.execute("PRAGMA journal_mode = DELETE")
    return folder


@pytest.fixture(autouse=True)
def _no_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("station.files.sqlite.PATIENCE_S", 0.05)
    monkeypatch.setattr("station.archive.reader.WRITTEN_S", 0.0)


def run_all(folder: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, int]:
    """Run every command; each ends with an exit code and says what it refuses in one line."""
    ended = {}
    for (name,) in COMMANDS:
        targets = {"export": [("csv",), ("json",), ("dfq",), ("reviewed",)], "report": [("html",)]}
        for forms in targets.get(name, [()]):
            arguments = ["records", name, str(folder)]
            if forms:
                target = folder.parent / f"out.{forms[0]}"
                shutil.rmtree(target, ignore_errors=True)
                target.unlink(missing_ok=True)
                arguments += [str(target), *(("--format", forms[0]) if name == "export" else ())]
            code = main(arguments)
            assert code in (0, 1, 2), (name, code)
            errors = capsys.readouterr().err
            if code == 2:
                assert errors.startswith("weldgate: ")
                assert len(errors.strip().splitlines()) == 1 or name == "verify"
            ended[name] = max(code, ended.get(name, 0))
    return ended


def copy_of(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "a"))


def test_the_whole_archive_is_good(whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert set(run_all(copy_of(whole, tmp_path), capsys).values()) == {0}


@pytest.mark.parametrize("name", ["index.sqlite", "journal.sqlite", "bus-2026-11-22.jsonl"])
@pytest.mark.parametrize("seed", range(12))
def test_bytes_changed_at_random(
    name: str, seed: int, whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, rng = copy_of(whole, tmp_path), random.Random(f"{name} {seed}")
    data = bytearray((folder / name).read_bytes())
    kind = seed % 4
    if kind == 0:
        del data[rng.randrange(len(data)) :]
    for _ in range((0, 1, 20, 400)[kind]):
        data[rng.randrange(len(data))] = rng.randrange(256)
    (folder / name).write_bytes(bytes(data))
    run_all(folder, capsys)


def set_column(table: str, column: str, value: Any) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        file = "index.sqlite" if table in ("records", "let_go", "segments") else "journal.sqlite"
        with closing(sqlite3.connect(folder / file)) as connection:
            for trigger in ("entries_stay", "entries_same"):
                connection.execute(f"DROP TRIGGER IF EXISTS {trigger}")
            number = "number" if table == "entries" else "inspection_id"
            connection.execute(f"UPDATE OR IGNORE {table} SET {column} = ? WHERE {number} = 2", (value,))
            connection.commit()

    return change


ODD = (
    *(b"\xff\xfe", 2**62, -1, 1e300, float("inf"), "", "\0", "9" * 5000, "../../../etc/passwd"),
    *("/dev/zero", "2026-11-22/00000001.json\n"),
)
COLUMNS = (
    *(("records", name) for name in ("serial", "trigger_id", "grabbed_at", "origin", "verdict", "reason")),
    *(("records", name) for name in ("worst_score", "frame_file", "record_file", "record_sha256", "chain")),
    *(("records", name) for name in ("shown_to_plc", "purpose", "recipe", "frame_state")),
    *(("entries", name) for name in ("at", "kind", "who", "subject", "before", "after", "reason", "chain")),
)


@pytest.mark.parametrize(("table", "column"), COLUMNS)
def test_a_column_that_holds_anything(
    table: str, column: str, whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number, value in enumerate(ODD):
        (tmp_path / str(number)).mkdir()
        folder = copy_of(whole, tmp_path / str(number))
        set_column(table, column, value)(folder)
        run_all(folder, capsys)


def _deep(_: dict[str, Any]) -> bytes:
    return b'{"a":' * 100_000


FINDING = {"kind": "hole", "start_deg": 1.0, "end_deg": 2.0, "length_mm": 0.1, "score": 0.9}


def _changed(place: tuple[str | int, ...], value: Any) -> Callable[[dict[str, Any]], bytes]:
    def change(raw: dict[str, Any]) -> bytes:
        inner: Any = raw
        raw["inspection"]["findings"] = [{**FINDING}]
        for name in place[:-1]:
            inner = inner[name]
        inner[place[-1]] = value
        return json.dumps(raw).encode()

    return change


TEXTS: tuple[Callable[[dict[str, Any]], bytes], ...] = (
    _deep,
    lambda _: b"",
    lambda _: b"[]",
    lambda _: b"\xff\xfe",
    lambda _: b"null",
    _changed(("format",), 3),
    _changed(("format",), 1),
    _changed(("format",), "x"),
    _changed(("inspection", "ring"), {"center_x_px": 1e308, "center_y_px": 0, "radius_px": -1, "support": 1}),
    _changed(("inspection", "findings", 0, "end_deg"), 1e300),
    _changed(("inspection", "findings", 0, "score"), float("nan")),
    _changed(("inspection", "findings", 0, "length_mm"), float("inf")),
    _changed(("inspection", "rejected"), []),
    _changed(("inspection", "scores"), []),
    _changed(("inspection", "unseen"), [None]),
    _changed(("inspection", "segment_quality"), [1]),
    _changed(("provenance", "thresholds", "kinds"), []),
    _changed(("provenance", "um_per_px"), 0),
    _changed(("serial",), "\ud800"),
    _changed(("grabbed_at",), "0001-01-01T00:00:00+23:59"),
)


@pytest.mark.parametrize("text", TEXTS, ids=range(len(TEXTS)))
def test_a_record_that_holds_anything(
    text: Callable[[dict[str, Any]], bytes], whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = copy_of(whole, tmp_path)
    (path,) = folder.rglob("00000002.json")
    data = text(json.loads(path.read_bytes()))
    path.write_bytes(data)
    set_column("records", "record_sha256", hashlib.sha256(data).hexdigest())(folder)
    assert run_all(folder, capsys)["verify"] == 1


@pytest.mark.parametrize(
    "name", ["2026-11-22/00000002.json", "2026-11-22/00000002.png", "bus-2026-11-22.jsonl"]
)
def test_a_fifo_or_a_folder_in_place_of_a_file_stops_nothing(
    name: str, whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for number, make in enumerate((os.mkfifo, os.mkdir)):
        (tmp_path / str(number)).mkdir()
        folder = copy_of(whole, tmp_path / str(number))
        (folder / name).unlink()
        make(folder / name)
        assert max(run_all(folder, capsys).values()) >= 1


@pytest.mark.parametrize("stray", ["99999999999999999999.json", "٣.json", "x.png", "-1.json"])
def test_files_of_others_in_the_archive_are_named(
    stray: str, whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = copy_of(whole, tmp_path)
    (folder / "2026-11-22" / stray).write_text("x")
    assert run_all(folder, capsys)["verify"] == 1


@pytest.mark.parametrize(
    "line", [b"{}", b"[1]", b"\xff", b"[" * 100_000, b'{"time": 1}', b"null", b'{"x": NaN}', b""]
)
def test_a_line_of_the_bus_log_that_holds_anything(
    line: bytes, whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = copy_of(whole, tmp_path)
    (folder / "bus-2026-11-22.jsonl").write_bytes(line + b"\n" + line)
    assert main(["records", "bus", str(folder)]) == 2
    assert "line 1 cannot be read" in capsys.readouterr().err


def test_a_search_for_anything_ends_with_a_code(
    whole: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = copy_of(whole, tmp_path)
    for options in (
        ("--serial", "\udcff"),
        ("--serial", "\udcff*"),
        ("--reason", "\udcff"),
        ("--serial", "\0"),
    ):
        assert main(["records", "list", str(folder), *options]) in (0, 2)
        assert "Traceback" not in capsys.readouterr().err


def test_a_damaged_index_makes_the_pruning_delete_nothing_of_others(whole: Path, tmp_path: Path) -> None:
    folder, other = copy_of(whole, tmp_path), tmp_path / "other.json"
    other.write_text("not of the archive")
    with closing(sqlite3.connect(folder / "index.sqlite")) as connection:
        connection.execute("INSERT INTO to_remove VALUES ('../other.json')")
        connection.execute("INSERT INTO to_remove VALUES (?)", (str(other),))
        connection.execute(
            "UPDATE records SET record_file = ?, frame_file = ?", ("../other.json", str(other))
        )
        connection.commit()
    keep = KeepSettings(ok_all_days=1, ok_days=1, nok_days=1, error_days=1, record_days=1)
    prune_archive(folder, keep, who="station", now=NOW + timedelta(days=3))
    assert other.read_text() == "not of the archive"


def test_a_file_that_is_not_regular_is_not_read(tmp_path: Path) -> None:
    for path in (Path("/dev/zero"), tmp_path, tmp_path / "a\0b"):
        with pytest.raises(OSError, match=r"regular|name|directory"):
            read_regular(path, 10)
    (tmp_path / "x").write_bytes(b"12345678901")
    with pytest.raises(OSError, match="larger"):
        read_regular(tmp_path / "x", 10)


def test_the_time_to_delete_a_file_does_not_grow_with_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Counted, not timed: no folder is listed, however many files it holds."""
    archive = Archive(ArchiveSettings(folder=tmp_path, **ROOMY))
    for number in range(30):
        when = NOW - timedelta(days=29 - number)
        archive.commit(
            archive.begin(None),
            nok_inspection(),
            Part("S", number + 1, Origin.SIMULATED),
            provenance(),
            now=NOW - timedelta(days=20) if number < 20 else when,
        )
    archive.close()

    def listed(*_: object) -> Any:
        raise AssertionError("a folder was listed")

    for name in ("listdir", "scandir"):
        monkeypatch.setattr(os, name, listed)
    keep = KeepSettings(record_days=15)
    done = prune_archive(tmp_path, keep, who="station", now=NOW)
    monkeypatch.undo()
    assert done.records == 20
    assert not (tmp_path / f"{NOW - timedelta(days=20):%Y-%m-%d}").exists()

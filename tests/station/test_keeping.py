"""Retention: what is kept and what is deleted, and that nothing else goes missing unnoticed."""

import csv
import json
import sqlite3
import threading
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from station.__main__ import main
from station.analysis.forms import FORMATS
from station.archive.prune import Pruned, sampled
from station.archive.prune import prune as prune_noting
from station.archive.reader import find, read_records, verify
from station.archive.room import Room
from station.archive.schema import VERSION
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import Frame, Image, Inspection, Origin
from station.engine.retention import Housekeeping
from station.errors import RecordError
from station.files.image import read_image
from station.records import Part
from station.settings.model import ArchiveSettings, KeepSettings
from tests.parts import label_with, nok_inspection, ok_inspection, provenance, unseen_inspection

NOW = datetime(2026, 11, 22, 12, tzinfo=UTC)
ROOMY = {"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 1}
KEEP = KeepSettings(ok_all_days=7, ok_share=0.25, ok_days=90, nok_days=730, error_days=365, record_days=1000)


def prune(folder: Path, keep: KeepSettings, now: datetime, *, dry: bool = False) -> Pruned:
    return prune_noting(folder, keep, now, note=lambda *_: None, dry=dry)


def fill(folder: Path, count: int, days_apart: float = 1.0, image: Image | None = None) -> None:
    """The newest is of now; every fourth NOK, every tenth not judged."""
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    image = np.zeros((16, 16), np.uint8) if image is None else image
    for number in range(count):
        when = NOW - timedelta(days=days_apart * (count - 1 - number))
        inspection = (
            Inspection.error(Reason.NO_WELD_FOUND)
            if number % 10 == 9
            else nok_inspection()
            if number % 4 == 3
            else ok_inspection()
        )
        frame = Frame(image, when, "cam", Origin.SIMULATED)
        archive.commit(
            archive.begin(frame),
            inspection,
            Part(f"P{number}", number + 1, Origin.SIMULATED),
            provenance(),
            now=when,
        )
    archive.close()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    fill(tmp_path / "a", 30)
    return tmp_path / "a"


def rewrite(folder: Path, sql: str) -> None:
    with sqlite3.connect(folder / "index.sqlite") as index:
        index.execute(sql)
    index.close()


def a_file(folder: Path, number: int, suffix: str) -> Path:
    (path,) = folder.rglob(f"{number:08d}.{suffix}")
    return path


def exchange(folder: Path) -> None:
    """Record 5 written again with another verdict, its hash in the index put right: only the chain tells."""
    import hashlib

    path = a_file(folder, 5, "json")
    path.write_text(path.read_text().replace('"serial": "P4"', '"serial": "PX"'))
    rewrite(
        folder,
        f"UPDATE records SET record_sha256 = '{hashlib.sha256(path.read_bytes()).hexdigest()}' "
        "WHERE inspection_id = 5",
    )


@pytest.mark.parametrize(
    ("harm", "place", "message"),
    [
        (lambda f: a_file(f, 7, "json").unlink(), "00000007.json", "cannot be read"),
        (lambda f: a_file(f, 7, "png").unlink(), "00000007.json", "its frame"),
        (lambda f: a_file(f, 7, "png").write_bytes(b"x"), "00000007.json", "was modified"),
        (
            lambda f: rewrite(f, "DELETE FROM records WHERE inspection_id IN (7, 8)"),
            "records 7 to 8",
            "were deleted",
        ),
        (
            lambda f: rewrite(f, "DELETE FROM records WHERE inspection_id < 3"),
            "records 1 to 2",
            "were deleted",
        ),
        (exchange, "00000005.json", "does not follow"),
        (
            lambda f: (f / "2026-11-22" / "00000005.json").write_text("{}"),
            "2026-11-22/00000005.json",
            "not in the index",
        ),
    ],
)
def test_what_is_missing_modified_or_deleted_is_named(
    harm: Callable[[Path], object], place: str, message: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert list(verify(folder)) == []
    assert main(["records", "verify", str(folder)]) == 0
    harm(folder)
    found = list(verify(folder))
    assert any(place in where and message in problem for where, problem in found), found
    assert main(["records", "verify", str(folder)]) == 1
    assert place in capsys.readouterr().err


def test_pictures_go_by_age_and_kind_and_the_rest_still_verifies(folder: Path) -> None:
    done = prune(folder, KEEP, NOW)
    rows = find(folder)
    assert len(rows) == 30
    for row in rows:
        young = datetime.fromisoformat(row.grabbed_at) >= NOW - timedelta(days=7)
        stays = young or row.verdict != "OK" or sampled(row.inspection_id, KEEP.ok_share)
        assert (row.frame_state == "kept") is stays
        assert (folder / str(row.frame_file)).exists() is stays
    assert done.frames == sum(row.frame_state == "pruned" for row in rows) > 5
    assert list(verify(folder)) == []
    assert [e.problem for e in read_records(folder)] == [None] * 30
    assert prune(folder, KEEP, NOW).frames == 0


def test_whole_records_go_from_the_oldest_and_the_chain_goes_on(folder: Path) -> None:
    assert prune(folder, KEEP.model_copy(update={"record_days": 9}), NOW).records == 20
    assert [row.inspection_id for row in find(folder)] == list(range(21, 31))
    assert list(verify(folder)) == []
    fill(folder, 1)
    assert list(verify(folder)) == []
    assert find(folder)[-1].inspection_id == 31
    assert prune(folder, KEEP.model_copy(update={"record_days": 1}), NOW + timedelta(days=6)).records == 11
    fill(folder, 2)
    assert list(verify(folder)) == []
    rewrite(folder, "DELETE FROM records WHERE inspection_id = 32")
    assert any("32 to 32" in where for where, _ in verify(folder))


def test_the_quota_lets_ok_go_before_nok(folder: Path) -> None:
    sizes = {row.inspection_id: (folder / str(row.frame_file)).stat().st_size for row in find(folder)}
    quota = sum(sizes.values()) - 5 * max(sizes.values())
    keep = KeepSettings(ok_all_days=999, ok_days=999, quota_gib=quota / (1 << 30))
    done = prune(folder, keep, NOW)
    deleted = [row for row in find(folder) if row.frame_state == "pruned"]
    assert {row.verdict for row in deleted} == {"OK"}
    assert len(deleted) == done.frames >= 5
    assert sum(s for n, s in sizes.items() if n not in {row.inspection_id for row in deleted}) <= quota


def test_a_dry_run_changes_nothing_and_says_the_same(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = sorted((p.name, p.stat().st_size) for p in folder.rglob("*.*") if "sqlite" not in p.name)
    dry = prune(folder, KEEP, NOW, dry=True)
    assert sorted((p.name, p.stat().st_size) for p in folder.rglob("*.*") if "sqlite" not in p.name) == before
    assert prune(folder, KEEP, NOW) == dry
    settings = folder.parent / "station.toml"
    settings.write_text('[camera]\nkind = "replay"\nfolder = "."\n')
    assert main(["records", "prune", str(folder), "--dry-run", "-c", str(settings)]) == 0
    assert capsys.readouterr().out.startswith("would delete ")


def test_a_dry_run_counts_nothing_twice(tmp_path: Path) -> None:
    fill(tmp_path / "a", 60, days_apart=4)
    keep = KEEP.model_copy(update={"quota_gib": 1e-9, "record_days": 100})
    assert prune(tmp_path / "a", keep, NOW, dry=True) == prune(tmp_path / "a", keep, NOW)
    assert list(verify(tmp_path / "a")) == []


def test_a_clock_that_is_wrong_costs_no_pictures(folder: Path) -> None:
    assert prune(folder, KEEP, NOW + timedelta(days=4000)).frames == 0, "far ahead of the newest record"
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    for when in (datetime(2000, 1, 1, tzinfo=UTC), NOW):
        frame = Frame(np.zeros((16, 16), np.uint8), when, "cam", Origin.SIMULATED)
        archive.commit(
            archive.begin(frame), nok_inspection(), Part("S", 1, Origin.SIMULATED), provenance(), now=when
        )
    archive.close()
    prune(folder, KEEP, NOW)
    assert [row.frame_state for row in find(folder)[-2:]] == ["kept", "kept"]


def test_what_a_stopped_pruning_left_is_removed_by_the_next(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("station.archive.prune._Work._remove", lambda *_: None)
    deleted = prune(folder, KEEP, NOW).frames
    pictures = len(list(folder.rglob("0*.png")))
    monkeypatch.undo()
    prune(folder, KEEP, NOW)
    assert len(list(folder.rglob("0*.png"))) == pictures - deleted


def test_a_lost_index_is_not_begun_again_over_the_records(folder: Path) -> None:
    for path in folder.glob("index.sqlite*"):
        path.unlink()
    with pytest.raises(RecordError, match="restore index"):
        Archive(ArchiveSettings(folder=folder, **ROOMY))


def test_a_modified_index_is_reported(folder: Path) -> None:
    rewrite(folder, "UPDATE records SET verdict = 'OK' WHERE inspection_id = 4")
    (place,) = [place for place, problem in verify(folder) if "the index was modified" in problem]
    assert place.endswith("00000004.json")


def test_verify_beside_an_engine_raises_no_false_alarm(folder: Path) -> None:
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    found, done = [], threading.Event()

    def look() -> None:
        while not done.is_set():
            found.extend(verify(folder))

    thread = threading.Thread(target=look)
    thread.start()
    frame = Frame(np.zeros((16, 16), np.uint8), NOW, "cam", Origin.SIMULATED)
    for _ in range(60):
        archive.commit(
            archive.begin(frame), ok_inspection(), Part("S", 1, Origin.SIMULATED), provenance(), now=NOW
        )
    prune(folder, KEEP, NOW)
    done.set()
    thread.join()
    archive.close()
    assert found == []


def test_the_engine_writes_while_it_is_pruned(tmp_path: Path) -> None:
    fill(tmp_path / "a", 400, days_apart=0.5)
    archive = Archive(ArchiveSettings(folder=tmp_path / "a", **ROOMY))
    pruned: list[int] = []
    thread = threading.Thread(target=lambda: pruned.append(prune(tmp_path / "a", KEEP, NOW).frames))
    thread.start()
    for number in range(60):
        archive.commit(
            archive.begin(None),
            ok_inspection(),
            Part(f"N{number}", 1, Origin.SIMULATED),
            provenance(),
            now=NOW,
        )
    thread.join()
    archive.close()
    assert pruned[0] > 50
    assert len(find(tmp_path / "a")) == 460
    assert list(verify(tmp_path / "a")) == []


def test_housekeeping_prunes_at_the_start_and_ends_at_once(folder: Path) -> None:
    keeper = Housekeeping(folder, KeepSettings(ok_all_days=1, ok_share=0, ok_days=1))
    for _ in range(200):
        if any(row.frame_state == "pruned" for row in find(folder)):
            break
        threading.Event().wait(0.02)
    keeper.close()
    assert not keeper._thread.is_alive()
    assert any(row.frame_state == "pruned" for row in find(folder))


@pytest.mark.parametrize(
    ("limits", "room", "kept", "takes_parts"),
    [
        ({"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 1}, Room.ENOUGH, [True, True], True),
        ({"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 10**9}, Room.LOW, [True, True], True),
        ({"min_free_mb": 1, "thin_free_mb": 10**9, "warn_free_mb": 10**9}, Room.THIN, [False, True], True),
        (
            {"min_free_mb": 10**9, "thin_free_mb": 10**9, "warn_free_mb": 10**9},
            Room.FULL,
            [False, False],
            False,
        ),
        (
            {"min_free_mb": 10**9, "thin_free_mb": 10**9, "warn_free_mb": 10**9, "when_full": "no_pictures"},
            Room.FULL,
            [False, False],
            True,
        ),
    ],
)
def test_three_levels_of_room(
    limits: dict[str, int], room: Room, kept: list[bool], takes_parts: bool, tmp_path: Path
) -> None:
    archive = Archive(ArchiveSettings.model_validate({"folder": tmp_path, **limits}))
    assert (archive.room(), archive.has_room()) == (room, takes_parts)
    frame = Frame(np.zeros((8, 8), np.uint8), NOW, "cam", Origin.SIMULATED)
    for inspection in (ok_inspection(), nok_inspection()):
        record = archive.commit(
            archive.begin(frame), inspection, Part("S", 1, Origin.SIMULATED), provenance(), now=NOW
        )
        assert record.frame_sha256 is not None, "the picture is known by its hash even if it is left out"
    archive.close()
    assert [row.frame_file is not None for row in find(tmp_path)] == kept
    assert list(verify(tmp_path)) == []


def test_an_archive_of_the_version_before_is_brought_up_to_date(tmp_path: Path) -> None:
    fill(tmp_path, 3)
    for statement in (
        "DROP TABLE segments",
        "DROP TABLE let_go",
        "DROP INDEX records_verdict",
        *(
            f"ALTER TABLE records DROP COLUMN {name}"
            for name in ("purpose", "recipe", "chain", "frame_state")
        ),
        "PRAGMA user_version = 0",
    ):
        rewrite(tmp_path, statement)
    with pytest.raises(RecordError, match="version 0"):
        find(tmp_path)
    fill(tmp_path, 2)
    assert [row.inspection_id for row in find(tmp_path)] == [1, 2, 3, 4, 5]
    assert list(verify(tmp_path)) == []
    rewrite(tmp_path, f"PRAGMA user_version = {VERSION + 1}")
    with pytest.raises(RecordError, match="index has version 3"):
        Archive(ArchiveSettings(folder=tmp_path, **ROOMY))


def test_a_clock_set_back_mixes_nothing_up(tmp_path: Path) -> None:
    archive = Archive(ArchiveSettings(folder=tmp_path, **ROOMY))
    for hours in (0, -1, -30, 1):
        archive.commit(
            archive.begin(None),
            ok_inspection(),
            Part("S", 1, Origin.SIMULATED),
            provenance(),
            now=NOW + timedelta(hours=hours),
        )
    archive.close()
    assert [row.inspection_id for row in find(tmp_path)] == [1, 2, 3, 4]
    assert list(verify(tmp_path)) == []


@pytest.mark.parametrize("form", [f for f in FORMATS if f not in ("parquet", "dataset")])
def test_records_are_exported(
    form: str, folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    target = tmp_path / "out"
    assert (
        main(["records", "export", str(folder), str(target), "--format", form, "--until", "2026-11-22"]) == 0
    )
    if form == "csv":
        rows = list(csv.DictReader(target.read_text().splitlines()))
        assert [row["inspection_id"] for row in rows] == [str(n) for n in range(1, 30)]
        assert float(rows[3]["p_nok_4"]) > 0.5
        assert rows[9]["p_nok_4"] == ""
    elif form == "json":
        assert len(json.loads(target.read_text())) == 29
    elif form == "dfq":
        lines = target.read_bytes().decode("cp1252").split("\r\n")
        values = [line for line in lines if "\x0f" in line]
        assert lines[0] == "K0100 21"
        assert len(values) == sum(row.verdict != "ERROR" for row in find(folder)[:29])
        assert all(len(line.split("\x0f")) == 21 for line in values)
        assert values[0].split("\x0f")[0].split("\x14")[2] == "24.10.2026/12:00:00"
    assert main(["records", "export", str(folder), str(target), "--format", form]) == 2
    assert "already exists" in capsys.readouterr().err


def test_crops_are_exported_by_what_was_found(
    tmp_path: Path, frames: dict[str, Image], capsys: pytest.CaptureFixture[str]
) -> None:
    fill(tmp_path / "a", 4, image=frames[label_with("OK")["frame"]])
    a_file(tmp_path / "a", 2, "png").write_bytes(b"x")
    assert main(["records", "export", str(tmp_path / "a"), str(tmp_path / "out"), "--format", "dataset"]) == 1
    assert "00000002.json: its frame" in capsys.readouterr().err
    crops = {
        kind: sorted(p.name for p in (tmp_path / "out" / kind).iterdir())
        for kind in ("ok", "hole", "missing_weld")
    }
    assert (len(crops["ok"]), crops["hole"], crops["missing_weld"]) == (3 * 21 - 1, ["00000004_04.png"], [])
    assert read_image(tmp_path / "out" / "hole" / "00000004_04.png").shape == (128, 128)


def test_a_segment_that_was_not_seen_is_exported_as_unknown_and_never_as_a_crop_to_learn_from(
    tmp_path: Path, frames: dict[str, Image]
) -> None:
    folder = tmp_path / "a"
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    frame = Frame(frames[label_with("OK")["frame"]], NOW, "cam", Origin.SIMULATED)
    part = Part("P1", 1, Origin.SIMULATED)
    archive.commit(archive.begin(frame), unseen_inspection(), part, provenance(), now=NOW)
    archive.close()
    for form in ("csv", "dfq", "dataset"):
        assert main(["records", "export", str(folder), str(tmp_path / form), "--format", form]) == 0
    (row,) = csv.DictReader((tmp_path / "csv").read_text().splitlines())
    assert (row["p_nok_4"], row["p_nok_5"]) == (f"{unseen_inspection().scores[3].nok}", "")
    assert row["detail"] == unseen_inspection().detail
    assert (row["worst_mean_dn"], row["worst_dark_fraction"], row["worst_visible"]) == ("3.0", "0.91", "")
    (values,) = [line for line in (tmp_path / "dfq").read_text("cp1252").splitlines() if "\x0f" in line]
    assert [value.split("\x14")[1] for value in values.split("\x0f")] == ["0"] * 4 + ["255"] + ["0"] * 16
    crops = {path.name for path in (tmp_path / "dataset" / "ok").iterdir()}
    assert crops == {f"00000001_{number:02d}.png" for number in range(1, 22) if number != 5}


def test_parquet_without_its_package_is_said(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["records", "export", str(folder), str(tmp_path / "p"), "--format", "parquet"]
    if find_spec("pyarrow") is None:
        assert main(command) == 2
        assert "weldgate[parquet]" in capsys.readouterr().err
    else:
        assert main(command) == 0
        assert (tmp_path / "p").read_bytes()[:4] == b"PAR1"

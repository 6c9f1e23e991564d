"""Finding records by what people know of them."""

import sqlite3
import subprocess
import sys
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from station.__main__ import main
from station.archive.reader import Query, find
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import Inspection, Origin
from station.records import Part
from station.settings.model import ArchiveSettings
from tests.parts import nok_inspection, ok_inspection, provenance

NOON = datetime(2026, 11, 22, 12, tzinfo=UTC)
ROOMY = {"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 1}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("archive")
    archive = Archive(ArchiveSettings(folder=made, **ROOMY))
    for number in range(30):
        inspection = nok_inspection() if number % 5 == 3 else ok_inspection()
        if number == 7:
            inspection = Inspection.error(Reason.NO_FRAME)
        part = Part(f"LOT{number // 10}-{number:03d}", number + 1, Origin.SIMULATED)
        archive.commit(
            archive.begin(None), inspection, part, provenance(), now=NOON + timedelta(minutes=number)
        )
    archive.close()
    return made


@pytest.mark.parametrize(
    ("wanted", "numbers"),
    [
        (Query(), list(range(1, 31))),
        (Query(serial="LOT1-013"), [14]),
        (Query(serial="LOT2*"), list(range(21, 31))),
        (Query(serial="LOT*", limit=3, newest_first=True), [30, 29, 28]),
        (Query(since=NOON + timedelta(minutes=10), until=NOON + timedelta(minutes=12)), [11, 12]),
        (Query(verdict="ERROR"), [8]),
        (Query(reason=str(Reason.NO_FRAME)), [8]),
        (Query(verdict="NOK"), [4, 9, 14, 19, 24, 29]),
        (Query(segment=4, min_score=0.5), [4, 9, 14, 19, 24, 29]),
        (Query(segment=5, min_score=0.5), []),
        (Query(min_score=0.5), [4, 9, 14, 19, 24, 29]),
        (Query(serial="nobody"), []),
    ],
)
def test_records_are_found(wanted: Query, numbers: list[int], folder: Path) -> None:
    assert [row.inspection_id for row in find(folder, wanted)] == numbers


def test_people_find_by_options(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (
        main(
            [
                "records",
                "list",
                str(folder),
                "--segment",
                "4",
                "--score",
                "0.5",
                "--last",
                "2",
                "--since",
                "2026-11-22T12:00",
            ]
        )
        == 0
    )
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == ["29", "24"]
    with pytest.raises(SystemExit):
        main(["records", "list", str(folder), "--since", "yesterday"])
    assert "is not a valid time" in capsys.readouterr().err


@pytest.mark.parametrize(
    "wanted",
    [
        Query(serial="LOT1-013"),
        Query(serial="LOT2*"),
        Query(since=NOON, until=NOON + timedelta(minutes=5)),
        Query(segment=4, min_score=0.9),
        Query(verdict="NOK", limit=100),
    ],
)
def test_every_search_goes_by_an_index(wanted: Query, folder: Path) -> None:
    """Never a walk through all records, which a hundred thousand would make slow."""
    seen: list[str] = []

    class Watched(sqlite3.Connection):
        def execute(self, sql: str, *values: object) -> sqlite3.Cursor:
            if sql.startswith("SELECT r."):
                plan = super().execute(f"EXPLAIN QUERY PLAN {sql}", *values).fetchall()  # type: ignore[arg-type]
                seen.extend(row[3] for row in plan)
            return super().execute(sql, *values)  # type: ignore[arg-type]

    real = sqlite3.connect
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sqlite3, "connect", lambda *a, **k: real(*a, **{**k, "factory": Watched}))
        find(folder, wanted)
    assert seen
    assert not [step for step in seen if step.startswith("SCAN")], seen


@pytest.mark.skipif(
    subprocess.run(["unshare", "-m", "true"], check=False).returncode != 0, reason="needs the right to mount"
)
def test_an_archive_on_a_disk_mounted_read_only_can_be_listed_and_verified(tmp_path: Path) -> None:
    folder = tmp_path / "records"
    archive = Archive(ArchiveSettings(folder=folder, **ROOMY))
    archive.commit(
        archive.begin(None),
        ok_inspection(),
        Part("CELL-1", 1, Origin.SIMULATED),
        provenance(),
        now=datetime.now(UTC),
    )
    archive.close()
    mount = (
        f"mount --bind '{folder}' '{folder}' && mount -o remount,ro,bind '{folder}' "
        f"&& ! touch '{folder}/x' 2>/dev/null"
    )
    look = " && ".join(
        f"'{sys.executable}' -m station records {name} '{folder}'" for name in ("list", "verify")
    )
    done = subprocess.run(
        ["unshare", "-m", "sh", "-c", f"{mount} && {look}"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert "CELL-1" in done.stdout
    assert "1 records, 0 journal entries, 0 problems" in done.stdout

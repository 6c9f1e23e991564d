import sqlite3
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import pytest

from station.archive.reader import read_records
from station.archive.writer import Archive
from station.defects import Reason
from station.domain import Frame, Image, Inspection, Origin
from station.errors import RecordError
from station.files.image import read_image
from station.records import Part, Record
from station.settings.model import ArchiveSettings
from tests.parts import nok_inspection, ok_inspection, provenance

ROOMY = {"min_free_mb": 1, "thin_free_mb": 1, "warn_free_mb": 1}


@pytest.fixture
def archive(tmp_path: Path) -> Iterator[Archive]:
    kept = Archive(ArchiveSettings(folder=tmp_path, **ROOMY))
    yield kept
    kept.close()


def put(archive: Archive, image: Image | None, inspection: Inspection, trigger_id: int = 5) -> Record:
    now = datetime.now(UTC)
    frame = None if image is None else Frame(image, now, "cam", Origin.SIMULATED)
    return archive.commit(
        archive.begin(frame), inspection, Part("S-1", trigger_id, Origin.SIMULATED), provenance(), now=now
    )


def test_what_is_written_reads_back_whole(archive: Archive, tmp_path: Path, rng: np.random.Generator) -> None:
    image = rng.integers(0, 256, (60, 80), dtype=np.uint8)
    written = [
        put(archive, image, ok_inspection()),
        put(archive, image, nok_inspection()),
        put(archive, None, Inspection.error(Reason.NO_FRAME)),
    ]
    read = list(read_records(tmp_path))
    assert [e.record for e in read] == written
    assert all(e.problem is None for e in read)
    assert written[0].frame_file is not None
    assert (read_image(tmp_path / written[0].frame_file) == image).all()


def test_numbers_go_on_after_a_restart(archive: Archive, tmp_path: Path) -> None:
    first = put(archive, None, Inspection.error(Reason.NO_FRAME))
    archive.close()
    again = Archive(ArchiveSettings(folder=tmp_path, **ROOMY))
    assert put(again, None, Inspection.error(Reason.NO_FRAME)).inspection_id == first.inspection_id + 1
    again.close()


@pytest.mark.parametrize(("suffix", "message"), [("json", "modified"), ("png", "modified")])
def test_a_changed_file_is_named(suffix: str, message: str, archive: Archive, tmp_path: Path) -> None:
    put(archive, np.zeros((8, 8), np.uint8), ok_inspection())
    (path,) = tmp_path.rglob(f"*.{suffix}")
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    (entry,) = read_records(tmp_path)
    assert entry.problem is not None
    assert message in entry.problem


def test_a_deleted_frame_is_named(archive: Archive, tmp_path: Path) -> None:
    put(archive, np.zeros((8, 8), np.uint8), ok_inspection())
    next(tmp_path.rglob("*.png")).unlink()
    (entry,) = read_records(tmp_path)
    assert entry.record is not None
    assert entry.problem is not None


def test_a_locked_index_is_an_error_and_lists_nothing(archive: Archive, tmp_path: Path) -> None:
    other = sqlite3.connect(tmp_path / "index.sqlite")
    other.execute("BEGIN EXCLUSIVE")
    with pytest.raises(RecordError, match="could not be written"):
        put(archive, None, Inspection.error(Reason.NO_FRAME))
    other.rollback()
    other.close()
    assert not archive.has_room(), "no parts while a record cannot be written"
    assert list(read_records(tmp_path)) == []
    archive._failed_s = -1e9
    assert archive.has_room(), "a trial succeeds again"
    put(archive, None, Inspection.error(Reason.NO_FRAME))


def test_a_second_engine_is_refused(archive: Archive, tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="another engine"):
        Archive(ArchiveSettings(folder=tmp_path, **ROOMY))


def test_the_index_says_whether_the_plc_was_shown(archive: Archive, tmp_path: Path) -> None:
    for shown in (True, False):
        archive.mark_shown(put(archive, None, Inspection.error(Reason.NO_FRAME)).inspection_id, shown)
    put(archive, None, Inspection.error(Reason.NO_FRAME))
    assert [e.shown_to_plc for e in read_records(tmp_path)] == [True, False, None]


def test_odd_folder_names_are_read(tmp_path: Path) -> None:
    folder = tmp_path / "rec#1 %41?ä"
    kept = Archive(ArchiveSettings(folder=folder, **ROOMY))
    put(kept, None, Inspection.error(Reason.NO_FRAME))
    kept.close()
    assert len(list(read_records(folder))) == 1


def test_a_file_in_the_way_of_the_folder_is_said(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("")
    with pytest.raises(RecordError, match=r"archive\.folder"):
        Archive(ArchiveSettings(folder=tmp_path / "x" / "records"))


def test_no_archive_is_said(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="no records found"):
        list(read_records(tmp_path))


def test_a_full_disk_is_seen(tmp_path: Path) -> None:
    kept = Archive(
        ArchiveSettings(folder=tmp_path, min_free_mb=10**9, thin_free_mb=10**9, warn_free_mb=10**9)
    )
    assert not kept.has_room()
    kept.close()

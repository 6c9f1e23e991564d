"""Recovery removes nothing: what an interrupted part or an old index left behind is moved aside and said."""

import shutil
from contextlib import closing
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from station.archive.reader import read_records, verify
from station.archive.writer import INCOMING, Archive
from station.defects import Reason
from station.domain import Inspection, Origin
from station.errors import RecordError
from station.records import Part
from station.settings.model import ArchiveSettings
from tests.parts import provenance

NOW = datetime(2026, 11, 28, 12, tzinfo=UTC)


def opened(folder: Path) -> Archive:
    return Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))


def put(archive: Archive, now: datetime = NOW) -> None:
    inspection, part = Inspection.error(Reason.NO_FRAME), Part("A", 1, Origin.CAMERA)
    archive.commit(archive.begin(None), inspection, part, provenance(), now=now)


def contents(folder: Path) -> set[bytes]:
    return {path.read_bytes() for path in folder.rglob("*") if path.suffix != ".sqlite" and path.is_file()}


@pytest.mark.parametrize("days", [0, 1, -20_000])
@pytest.mark.parametrize("behind", [1, 2])
def test_an_index_that_lies_behind_costs_no_file(tmp_path: Path, days: int, behind: int) -> None:
    """The records that the restored index lacks may be of any day, if the clock was wrong."""
    folder, saved = tmp_path / "records", tmp_path / "index.sqlite"
    with closing(opened(folder)) as archive:
        put(archive)
    shutil.copy(folder / "index.sqlite", saved)
    with closing(opened(folder)) as archive:
        for _ in range(behind):
            put(archive, NOW + timedelta(days=days))
    before = contents(folder)
    for extra in folder.glob("index.sqlite*"):
        extra.unlink()
    shutil.copy(saved, folder / "index.sqlite")
    if behind > 1:
        with pytest.raises(RecordError, match="restore index"):
            opened(folder)
    else:
        with closing(opened(folder)) as archive:
            put(archive)
        assert len(list((folder / "aside").iterdir())) == 1
        assert [entry.row.inspection_id for entry in read_records(folder)] == [1, 2]
        assert not list(verify(folder))
    assert before <= contents(folder)


def test_what_is_left_of_an_interrupted_part_is_moved_aside_and_said(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    for number in range(3):
        with closing(opened(tmp_path)) as archive:
            put(archive)
        (tmp_path / INCOMING).write_bytes(b"frame %d" % number)
        (tmp_path / f"{INCOMING}.new.part").write_bytes(b"half of frame %d" % number)
        day = tmp_path / f"{NOW:%Y-%m-%d}"
        (day / f"{number + 2:08d}.json").write_bytes(b"record %d" % number)
        (day / f"{number + 2:08d}.png").write_bytes(b"image %d" % number)
    with closing(opened(tmp_path)) as archive:
        put(archive)
    found = contents(tmp_path / "aside")
    kinds = ("frame", "half of frame", "record", "image")
    assert found == {f"{kind} {number}".encode() for kind in kinds for number in range(3)}
    assert caplog.text.count("was left behind") == 12
    assert [entry.row.inspection_id for entry in read_records(tmp_path)] == [1, 2, 3, 4]
    assert not list(verify(tmp_path))


def test_a_record_that_failed_in_the_index_is_kept_when_its_number_is_used(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(*_: object) -> None:
        raise OSError(28, "no space")

    with closing(opened(tmp_path)) as archive:
        with monkeypatch.context() as patch:
            patch.setattr(Archive, "_list", fails)
            with pytest.raises(RecordError):
                put(archive)
        text = (tmp_path / f"{NOW:%Y-%m-%d}" / "00000001.json").read_bytes()
        put(archive)
    assert contents(tmp_path / "aside") == {text}

"""An archive that is unexpectedly empty or another is refused; a master check holds for one judge."""

import json
from contextlib import closing
from dataclasses import fields, replace
from datetime import UTC, datetime
from pathlib import Path
from shutil import copytree, rmtree
from types import SimpleNamespace

import pytest

from station.__main__ import main
from station.archive.writer import Archive
from station.domain import Origin, Purpose, Verdict
from station.engine.archive_identity import MARKER, check_archive, note_archive, note_of
from station.engine.self_checks import Master, SelfChecks
from station.engine.startup import _master
from station.errors import RecordError
from station.inspection.loading import Loaded
from station.records import Part, Provenance
from station.settings.model import ArchiveSettings
from tests.parts import nok_inspection, ok_inspection, provenance


def start(settings: Path, folder: Path) -> None:
    """Do what the start of the engine does."""
    check_archive(settings, folder)
    with closing(Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1))):
        note_archive(settings, folder)


@pytest.fixture
def station(tmp_path: Path) -> tuple[Path, Path]:
    settings, folder = tmp_path / "station.toml", tmp_path / "records"
    settings.write_text(f'[camera]\nkind = "replay"\nfolder = "x"\n[archive]\nfolder = "{folder}"\n')
    for _ in range(3):
        start(settings, folder)
    return settings, folder


def test_an_archive_that_is_missing_is_refused_and_nothing_is_made(station: tuple[Path, Path]) -> None:
    settings, folder = station
    rmtree(folder)
    with pytest.raises(RecordError, match=r"is missing or empty.*weldgate new-archive"):
        start(settings, folder)
    assert not folder.exists()
    folder.mkdir()  # the mount point without its disk
    with pytest.raises(RecordError, match="is missing or empty"):
        start(settings, folder)
    assert not list(folder.iterdir())


def test_an_archive_without_its_index_is_refused(station: tuple[Path, Path]) -> None:
    settings, folder = station
    (folder / "index.sqlite").unlink()
    with pytest.raises(RecordError, match=r"has no index\.sqlite"):
        start(settings, folder)


def test_another_archive_is_refused_and_a_moved_one_is_not(
    station: tuple[Path, Path], tmp_path: Path
) -> None:
    settings, folder = station
    start(tmp_path / "other.toml", tmp_path / "other")
    with pytest.raises(RecordError, match="is another one"):
        start(settings, tmp_path / "other")
    copytree(folder, tmp_path / "moved")
    start(settings, tmp_path / "moved")


def test_a_person_says_that_a_new_archive_begins(
    station: tuple[Path, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    settings, folder = station
    noted = note_of(settings).read_bytes()
    rmtree(folder)
    assert main(["new-archive", "-c", str(settings)]) == 0
    assert f"{folder}: the next start takes it" in capsys.readouterr().out
    start(settings, folder)
    start(settings, folder)
    assert note_of(settings).read_bytes() != noted
    assert note_of(settings).with_name("station.archive.json.1").read_bytes() == noted


@pytest.mark.parametrize("content", ["", "{}", "[]", '{"archive": 1}', "\0"])
def test_a_damaged_note_or_marker_is_refused(station: tuple[Path, Path], content: str) -> None:
    settings, folder = station
    note_of(settings).write_text(content)
    with pytest.raises(RecordError, match=r"archive\.json: cannot be read"):
        start(settings, folder)
    note_of(settings).write_text(json.dumps({"archive": "a"}))
    (folder / MARKER).write_bytes(b"\xff")
    with pytest.raises(RecordError, match=r"archive\.id: cannot be read"):
        start(settings, folder)


def test_an_archive_of_before_gets_its_marker(tmp_path: Path) -> None:
    folder = tmp_path / "records"
    with closing(Archive(ArchiveSettings(folder=folder, min_free_mb=1, thin_free_mb=1))):
        pass
    start(tmp_path / "station.toml", folder)
    assert (folder / MARKER).exists()


# The check of a master holds for the judge that made it

OTHERS = {
    "software": "0.0.1",
    "model_hash": "other",
    "ring_model_hash": "other",
    "seen_model_hash": "other",
    "config_crc": 1,
    "limits_hash": "other",
    "recipe": 9,
    "um_per_px": 20.0,
    "model_version": "9",
}


@pytest.mark.parametrize("name", [*OTHERS, "thresholds"])
@pytest.mark.parametrize("right", [True, False])
def test_a_master_that_another_judge_found_right_counts_as_unchecked_and_wrong_stays_wrong(
    tmp_path: Path, name: str, right: bool
) -> None:
    judge = provenance()
    assert {*OTHERS, "thresholds"} == {field.name for field in fields(Provenance)}
    limits = judge.thresholds
    kind = replace(limits.kinds[0], threshold=0.77)
    other = replace(limits, kinds=(kind, *limits.kinds[1:])) if name == "thresholds" else OTHERS[name]
    with closing(Archive(ArchiveSettings(folder=tmp_path, min_free_mb=1, thin_free_mb=1))) as archive:
        found = ok_inspection() if right else nok_inspection()
        part = Part("M", 1, Origin.CAMERA, Purpose.GOLDEN)
        archive.commit(archive.begin(None), found, part, judge, now=datetime.now(UTC))
    same, _ = _master(tmp_path, "M", Verdict.OK, judge)
    assert (same.wrong, same.found) == (not right, found.verdict)
    judge_then = replace(judge, **{name: other})  # type: ignore[arg-type]
    changed, _ = _master(tmp_path, "M", Verdict.OK, judge_then)
    assert changed == (Master(Verdict.OK) if right else same)


def recipe(number: int) -> Loaded:
    return Loaded(
        number,
        SimpleNamespace(reference=None),  # type: ignore[arg-type]
        replace(provenance(), recipe=number),
        None,
    )


@pytest.mark.parametrize("restarted", [False, True])
def test_a_wrong_master_is_not_made_good_by_its_check_under_another_recipe(
    tmp_path: Path, restarted: bool
) -> None:
    """Wrong by recipe 1, right by recipe 2, then recipe 1 again; what was right counts again."""
    checks = SelfChecks(recipe(1), {"M": Master(Verdict.OK)}, 3600.0, 1e9)
    with closing(Archive(ArchiveSettings(folder=tmp_path, min_free_mb=1, thin_free_mb=1))) as archive:
        for number, found in ((1, nok_inspection()), (2, ok_inspection())):
            part = Part("M", number, Origin.CAMERA, Purpose.GOLDEN)
            judge = recipe(number).provenance
            archive.commit(archive.begin(None), found, part, judge, now=datetime.now(UTC))
            checks.use(recipe(number))
            checks.master_judged("M", found.verdict)
    assert checks.trusted
    if restarted:
        master, history = _master(tmp_path, "M", Verdict.OK, recipe(2).provenance)
        checks = SelfChecks(recipe(2), {"M": master}, 3600.0, 1e9, history=history)
    seen = []
    for number in (3, 2, 1):
        checks.use(recipe(number))
        seen.append((checks.trusted, checks.masters_due))
    assert seen == [(True, True), (True, False), (False, False)]
    if restarted:
        assert _master(tmp_path, "M", Verdict.OK, recipe(1).provenance)[0].wrong

"""The journal only grows, and what is altered is named; users live in it."""

import sqlite3
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing, contextmanager
from multiprocessing import get_context
from pathlib import Path

import pytest

from station.__main__ import main
from station.archive.reader import find
from station.archive.schema import NAME as INDEX
from station.archive.schema import open_index
from station.errors import RecordError
from station.journal.journal import NAME, Kind, entries, verify_journal
from station.journal.journal_writer import append


def test_entries_are_found_by_kind_and_subject(tmp_path: Path) -> None:
    assert entries(tmp_path) == []
    append(
        tmp_path,
        Kind.SETTING,
        "Ada",
        "hole_threshold",
        before="0.46",
        after="0.5",
        reason="too many false calls",
    )
    append(tmp_path, Kind.REVIEW, "Ada", "12", after="false call")
    append(tmp_path, Kind.REVIEW, "Bob", "13", after="confirmed")
    (entry,) = entries(tmp_path, (Kind.SETTING,))
    assert (entry.who, entry.before, entry.after, entry.reason) == (
        "Ada",
        "0.46",
        "0.5",
        "too many false calls",
    )
    assert [e.subject for e in entries(tmp_path, (Kind.REVIEW,))] == ["13", "12"]
    assert [e.number for e in entries(tmp_path, (Kind.REVIEW,), subject="12")] == [2]
    assert [e.number for e in entries(tmp_path, newest_first=False, limit=2)] == [1, 2]


def test_nothing_can_be_changed_or_removed_and_a_forger_is_found(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    open_index(tmp_path).close()
    for number in range(4):
        append(tmp_path, Kind.SETTING, "Ada", f"key {number}", before="1", after="2", reason="because")
    with closing(sqlite3.connect(tmp_path / NAME)) as connection:
        for forbidden in ("DELETE FROM entries", "UPDATE entries SET who = 'Eve'"):
            with pytest.raises(sqlite3.IntegrityError, match="only grows"):
                connection.execute(forbidden)
    assert list(verify_journal(tmp_path)) == []
    assert main(["records", "verify", str(tmp_path)]) == 0
    with closing(sqlite3.connect(tmp_path / NAME)) as connection:
        connection.executescript("DROP TRIGGER entries_stay; DELETE FROM entries WHERE number = 2;")
    assert list(verify_journal(tmp_path)) == [
        (f"{NAME}, entry 3", "was modified, or the entry before it was deleted")
    ]
    assert main(["records", "verify", str(tmp_path)]) == 1
    assert "entry 3" in capsys.readouterr().err


@pytest.mark.parametrize(
    "pool",
    [ThreadPoolExecutor(4), ProcessPoolExecutor(4, get_context("spawn"))],
    ids=["threads", "processes"],
)
def test_many_writers_keep_one_chain(pool: Executor, tmp_path: Path) -> None:
    with pool:
        writing = [pool.submit(append, tmp_path, Kind.ALARM, "station", str(number)) for number in range(40)]
        seen = 0
        while not all(entry.done() for entry in writing):  # readers are there from the first moment
            assert list(verify_journal(tmp_path)) == []
            before, seen = seen, len(entries(tmp_path))
            assert seen >= before
    assert {entry.result().subject for entry in writing} == {str(number) for number in range(40)}
    assert len(entries(tmp_path)) == 40
    assert list(verify_journal(tmp_path)) == []


@contextmanager
def _released_later(release: Callable[[], None]) -> Iterator[None]:
    """Do what another process does a moment later."""
    timer = threading.Timer(0.2, release)
    timer.start()
    try:
        yield
    finally:
        timer.join()


def test_a_writer_of_a_journal_that_is_not_yet_in_wal_mode_is_waited_for(tmp_path: Path) -> None:
    """SQLite itself does not wait for a writer where a file changes its mode."""
    with closing(sqlite3.connect(tmp_path / NAME, check_same_thread=False)) as other:
        other.execute("CREATE TABLE left_by_a_stop (x)")
        other.execute("BEGIN IMMEDIATE")
        with _released_later(other.rollback):
            append(tmp_path, Kind.ALARM, "station", "1")
    assert [e.subject for e in entries(tmp_path)] == ["1"]


def test_a_journal_or_index_that_is_just_being_made_is_waited_for(tmp_path: Path) -> None:
    for name in (NAME, INDEX):
        (tmp_path / name).touch()
    with _released_later(lambda: append(tmp_path, Kind.ALARM, "station", "1")):
        assert [e.subject for e in entries(tmp_path)] == ["1"]
    with _released_later(lambda: open_index(tmp_path).close()):
        assert find(tmp_path) == []


def test_a_folder_that_cannot_be_written_is_said(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="nothing was changed"):
        append(tmp_path / "absent", Kind.LOGIN, "Ada")


@pytest.mark.parametrize("before", [None, 0o644, 0o666, 0o604])
@pytest.mark.parametrize("name", [NAME, INDEX])
def test_no_database_is_for_everybody(tmp_path: Path, name: str, before: int | None) -> None:
    """The journal holds hashes of PINs, and who may read the index may hold a lock that its writer needs."""

    def write() -> None:
        if name == NAME:
            append(tmp_path, Kind.LOGIN, "Ada")
        else:
            open_index(tmp_path).close()

    if before is not None:
        write()
        (tmp_path / name).chmod(before)
    with closing(sqlite3.connect(tmp_path / name)) as other:
        write()
        other.execute("SELECT * FROM sqlite_master").fetchall()
        write()
        found = [path for path in tmp_path.glob(f"{name}*") if not path.name.endswith(".lock")]
        assert len(found) == 3
        for path in found:
            assert not path.stat().st_mode & 0o007, path.name

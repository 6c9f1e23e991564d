"""The journal only grows, and what is altered is named; users live in it."""

import sqlite3
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import closing, contextmanager
from datetime import UTC, datetime, timedelta
from multiprocessing import get_context
from pathlib import Path

import pytest

import station.journal.accounts
from station.__main__ import main
from station.archive.reader import find
from station.archive.schema import NAME as INDEX
from station.archive.schema import open_index
from station.errors import LoginError, RecordError
from station.journal.accounts import log_in, log_out, remove_user, save_user
from station.journal.journal import NAME, Kind, entries, verify_journal
from station.journal.journal_writer import append
from station.journal.users import Level, User, users


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


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    save_user(tmp_path, "Ada", level=Level.ADMIN, pin="1234", by="Ada")
    save_user(tmp_path, "Bob", level=Level.SETTER, pin="56789", by="Ada")
    return tmp_path


def test_users_come_go_and_change(folder: Path) -> None:
    assert users(folder) == [User("Ada", Level.ADMIN), User("Bob", Level.SETTER)]
    assert log_in(folder, "Bob", "56789") == User("Bob", Level.SETTER)
    save_user(folder, "Bob", level=Level.QUALITY, pin="0000", by="Ada")
    with pytest.raises(LoginError, match="wrong PIN"):
        log_in(folder, "Bob", "56789")
    log_out(folder, log_in(folder, "Bob", "0000"), "asked to")
    remove_user(folder, "Bob", by="Ada")
    assert users(folder) == [User("Ada", Level.ADMIN)]
    with pytest.raises(LoginError, match="unknown name or wrong PIN"):
        log_in(folder, "Bob", "0000")
    told = [(e.kind, e.before) for e in entries(folder, (Kind.USER,), "Bob", newest_first=False)]
    assert told == [(Kind.USER, ""), (Kind.USER, "setter"), (Kind.USER, "quality")]


@pytest.mark.parametrize(
    ("name", "level", "pin", "said"),
    [
        ("", Level.SETTER, "1234", "a name"),
        ("Eve", Level.SETTER, "123", "a PIN of 4 to 12 digits"),
        ("Eve", Level.SETTER, "12a4", "a PIN"),
        ("Ada", Level.SETTER, "1234", "at least one administrator"),
    ],
)
def test_users_that_cannot_be_are_refused(folder: Path, name: str, level: Level, pin: str, said: str) -> None:
    with pytest.raises(LoginError, match=said):
        save_user(folder, name, level=level, pin=pin, by="Ada")
    with pytest.raises(LoginError, match="at least one administrator"):
        remove_user(folder, "Ada", by="Ada")


def test_five_wrong_pins_lock_for_a_minute_and_are_logged(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for _ in range(5):
        with pytest.raises(LoginError, match="wrong PIN"):
            log_in(folder, "Bob", "9999")
    with pytest.raises(LoginError, match="locked for") as caught:
        log_in(folder, "Bob", "56789")
    assert 50 < caught.value.locked_s <= 60
    assert log_in(folder, "Ada", "1234").name == "Ada", "others are not locked"
    assert len(entries(folder, (Kind.LOGIN_FAILED,), "Bob")) == 5

    class Later(datetime):
        @classmethod
        def now(cls, tz: object = None) -> datetime:  # type: ignore[override]
            return datetime.now(UTC) + timedelta(seconds=61)

    monkeypatch.setattr(station.journal.accounts, "datetime", Later)
    assert log_in(folder, "Bob", "56789").level is Level.SETTER

"""Users, their PINs and the commissioning code: what is counted, when it is checked, who can read what."""

import json
import os
import sqlite3
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.__main__ import main
from station.errors import LoginError
from station.journal import pins
from station.journal.accounts import NO_USERS, TOO_SHORT, WRONG, WRONG_CODE, Accounts
from station.journal.commissioning import make_code
from station.journal.journal import NAME, Kind, entries
from station.journal.journal_writer import append
from station.journal.pins import KEY
from station.journal.tries import LOCKED_S, TRIES, Tries
from station.journal.users import Level, User, users
from station.settings.file import load
from station.settings.keys import keys_folder
from tests.station.test_settings import GOOD

PIN = "123456"


class Clock:
    """A monotonic clock in hand."""

    def __init__(self) -> None:
        self.now_s = 1000.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def accounts(tmp_path: Path, clock: Clock) -> Accounts:
    made = Accounts(tmp_path, tmp_path / "keys", clock=clock)
    made.save_user("Ada", level=Level.ADMIN, pin=PIN, by="Ada")
    made.save_user("Bob", level=Level.SETTER, pin="56789", by="Ada")
    return made


@pytest.fixture
def checked(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """PINs that were checked, by a check that takes its time."""
    found: list[str] = []
    right = pins._hash

    def slow(pin: str, salt: str, key: bytes) -> str:
        found.append(pin)
        return right(pin, salt, key)

    monkeypatch.setattr(pins, "_hash", slow)
    return found


def test_users_come_go_and_change(accounts: Accounts, tmp_path: Path) -> None:
    assert users(tmp_path) == [User("Ada", Level.ADMIN), User("Bob", Level.SETTER)]
    assert accounts.log_in("Bob", "56789") == User("Bob", Level.SETTER)
    accounts.save_user("Bob", level=Level.QUALITY, pin="000000", by="Ada")
    with pytest.raises(LoginError, match=WRONG):
        accounts.log_in("Bob", "56789")
    accounts.log_out(accounts.log_in("Bob", "000000"), "asked to")
    accounts.remove_user("Bob", by="Ada")
    assert users(tmp_path) == [User("Ada", Level.ADMIN)]
    with pytest.raises(LoginError, match=WRONG):
        accounts.log_in("Bob", "000000")
    told = [(e.kind, e.before) for e in entries(tmp_path, (Kind.USER,), "Bob", newest_first=False)]
    assert told == [(Kind.USER, ""), (Kind.USER, "setter"), (Kind.USER, "quality")]


@pytest.mark.parametrize(
    ("name", "level", "pin", "said"),
    [
        ("", Level.SETTER, "1234", "a name"),
        ("Eve\nx", Level.SETTER, "1234", "a name"),
        ("E" * 41, Level.SETTER, "1234", "a name"),
        ("Eve", Level.SETTER, "123", "a PIN of 4 to 12 digits"),
        ("Eve", Level.SETTER, "12a4", "a PIN"),
        ("Eve", Level.SETTER, "١٢٣٤", "a PIN"),
        ("Eve", Level.QUALITY, "12345", "a PIN of 6 to 12 digits"),
        ("Eve", Level.ADMIN, "12345", "a PIN of 6 to 12 digits"),
        ("Ada", Level.SETTER, "1234", "at least one administrator"),
    ],
)
def test_users_that_cannot_be_are_refused(
    accounts: Accounts, name: str, level: Level, pin: str, said: str
) -> None:
    with pytest.raises(LoginError, match=said):
        accounts.save_user(name, level=level, pin=pin, by="Ada")
    with pytest.raises(LoginError, match="at least one administrator"):
        accounts.remove_user("Ada", by="Ada")


def test_five_wrong_pins_lock_for_a_minute_and_are_logged(
    accounts: Accounts, tmp_path: Path, clock: Clock, checked: list[str]
) -> None:
    for _ in range(5):
        with pytest.raises(LoginError, match=WRONG):
            accounts.log_in("Bob", "9999", source="user id 7")
    checked.clear()
    with pytest.raises(LoginError, match="locked for") as caught:
        accounts.log_in("Bob", "56789")
    assert checked == [], "a locked PIN is not even looked at"
    assert caught.value.locked_s == 60
    assert accounts.log_in("Ada", PIN).name == "Ada", "others are not locked"
    assert [e.reason for e in entries(tmp_path, (Kind.LOGIN_FAILED,), "Bob")] == ["user id 7"] * 5
    clock.now_s += 61
    assert accounts.log_in("Bob", "56789").level is Level.SETTER


def test_tries_in_parallel_are_counted_before_they_are_checked(
    accounts: Accounts, checked: list[str]
) -> None:
    start = threading.Barrier(24)

    def guess(number: int) -> str:
        start.wait()
        try:
            accounts.log_in("Bob", f"{number:04}")
        except LoginError as error:
            return str(error)
        return ""

    with ThreadPoolExecutor(24) as threads:
        answers = list(threads.map(guess, range(24)))
    assert len(checked) == TRIES
    assert answers.count(WRONG) == TRIES
    assert sum("is locked" in answer for answer in answers) == 24 - TRIES


def test_no_date_in_the_journal_locks_or_frees_anybody(
    accounts: Accounts, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A clock that was a year ahead for a moment locked a user for a year."""
    for year in ("1970", "2037"):
        for _ in range(4):
            with pytest.raises(LoginError, match=WRONG):
                accounts.log_in("Bob", "0000")
        with closing(sqlite3.connect(tmp_path / NAME)) as connection:
            connection.execute("DROP TRIGGER IF EXISTS entries_same")
            connection.execute("UPDATE entries SET at = ? || substr(at, 5)", [year])
            connection.commit()
        assert accounts.log_in("Bob", "56789").name == "Bob"


def test_a_restart_gives_nobody_further_tries(accounts: Accounts, tmp_path: Path, clock: Clock) -> None:
    for name in ("Bob", "Nobody"):
        for _ in range(5):
            with pytest.raises(LoginError, match=WRONG):
                accounts.log_in(name, "0000")
    again = Accounts(tmp_path, tmp_path / "keys", clock=clock)
    for name in ("Bob", "Nobody"):
        with pytest.raises(LoginError, match="is locked"):
            again.log_in(name, "56789")
    clock.now_s += 61
    assert again.log_in("Bob", "56789").name == "Bob"


@given(st.lists(st.tuples(st.floats(0, 90), st.booleans()), max_size=60))
def test_in_no_minute_are_more_than_five_tries_checked(steps: list[tuple[float, bool]]) -> None:
    now = [0.0]
    tries, checked, left = Tries(lambda: now[0]), list[float](), list[float]()
    for wait_s, _ in steps:
        now[0] += wait_s
        try:
            tries.begin("Bob")
        except LoginError as error:
            left.append(error.locked_s)
        else:
            checked.append(now[0])
    assert all(0 < locked_s <= LOCKED_S for locked_s in left)
    for place in range(len(checked) - TRIES):
        assert checked[place + TRIES] - checked[place] >= LOCKED_S


def test_unknown_names_share_their_tries_and_take_as_long(
    accounts: Accounts, tmp_path: Path, checked: list[str]
) -> None:
    for number in range(5):
        with pytest.raises(LoginError, match=WRONG):
            accounts.log_in(f"No{number}\n", "0000")
    assert len(checked) == 5
    with pytest.raises(LoginError, match="is locked"):
        accounts.log_in("No6", "0000")
    failed = entries(tmp_path, (Kind.LOGIN_FAILED,))
    assert len(failed) == 5, "a guesser does not fill the journal"
    assert all(entry.who.isprintable() for entry in failed)


def test_pins_of_earlier_versions_still_count_unless_they_are_too_short(
    accounts: Accounts, tmp_path: Path
) -> None:
    for name, level, pin in (("Old", 2, "4321"), ("Boss", 4, "4321"), ("Chief", 4, "654321")):
        hashed = pins._hash(pin, "00" * 16, b"")
        after = f'{{"level": {level}, "salt": "{"00" * 16}", "hash": "{hashed}"}}'
        append(tmp_path, Kind.USER, "Ada", name, after=after)
    assert accounts.log_in("Old", "4321").level is Level.SETTER
    assert accounts.log_in("Chief", "654321").level is Level.ADMIN
    with pytest.raises(LoginError, match=TOO_SHORT):
        accounts.log_in("Boss", "4321")
    with pytest.raises(LoginError, match=WRONG):
        accounts.log_in("Boss", "4322")


def test_the_journal_alone_is_worth_nothing_to_a_guesser(accounts: Accounts, tmp_path: Path) -> None:
    (entry,) = entries(tmp_path, (Kind.USER,), "Bob")
    stored = json.loads(entry.after)
    assert pins._hash("56789", stored["salt"], b"") != stored["hash"]
    key = tmp_path / "keys" / KEY
    assert key.stat().st_mode & 0o777 == 0o600
    assert key.parent.stat().st_mode & 0o777 == 0o700
    key.rename(tmp_path / "elsewhere")
    with pytest.raises(LoginError, match="the key of the PINs cannot be used"):
        accounts.log_in("Bob", "56789")
    (tmp_path / "elsewhere").rename(key)
    for mode in (0o604, 0o640, 0o602):
        key.chmod(mode)
        with pytest.raises(LoginError, match="other accounts may read or write it"):
            accounts.log_in("Bob", "56789")


def test_one_code_makes_one_administrator_however_many_enter_it_at_once(tmp_path: Path) -> None:
    accounts = Accounts(tmp_path, tmp_path / "keys")
    code, start = make_code(tmp_path / "keys"), threading.Barrier(5)

    def enter(number: int) -> str:
        start.wait()
        try:
            return accounts.commission(f"P{number}", PIN, code).name
        except LoginError as error:
            return str(error)

    with ThreadPoolExecutor(5) as threads:
        answers = list(threads.map(enter, range(5)))
    assert answers.count(WRONG_CODE) == 4
    assert len(users(tmp_path)) == 1


def test_codes_cannot_be_guessed_planted_or_kept(tmp_path: Path, clock: Clock) -> None:
    accounts, keys = Accounts(tmp_path, tmp_path / "keys", clock=clock), tmp_path / "keys"
    with pytest.raises(LoginError, match=NO_USERS):
        accounts.log_in("Eve", PIN)
    with pytest.raises(LoginError, match=WRONG_CODE):
        accounts.commission("Eve", PIN, "")
    first, code = make_code(keys), make_code(keys)
    (keys / "commissioning.json").chmod(0o666)
    with pytest.raises(LoginError, match="other accounts may"):
        accounts.commission("Eve", PIN, code)
    (keys / "commissioning.json").chmod(0o600)
    with pytest.raises(LoginError, match=WRONG_CODE):
        accounts.commission("Eve", PIN, first)
    assert accounts.commission("Ada", PIN, code.replace("-", " ")).level is Level.ADMIN
    assert [e.reason for e in entries(tmp_path, (Kind.USER,))] == ["commissioning code"]
    clock.now_s += 61
    with pytest.raises(LoginError, match="this name exists"):
        accounts.commission("Ada", "999999", make_code(keys))
    for _ in range(4):
        with pytest.raises(LoginError, match=WRONG_CODE):
            accounts.commission("Eve", PIN, "1234-5678-9012")
    with pytest.raises(LoginError, match="is locked"):
        accounts.commission("Eve", PIN, make_code(keys))


@pytest.mark.parametrize("name", ["", "  ", "a\nb", "x" * 41, " Ada "])
def test_a_name_that_cannot_be_used_does_not_use_up_the_code(tmp_path: Path, clock: Clock, name: str) -> None:
    accounts, keys = Accounts(tmp_path, tmp_path / "keys", clock=clock), tmp_path / "keys"
    accounts.commission("Ada", PIN, make_code(keys))
    code = make_code(keys)
    with pytest.raises(LoginError, match=r"a name of 1 to 40|this name exists"):
        accounts.commission(name, "999999", code)
    assert accounts.log_in("Ada", PIN).level is Level.ADMIN
    assert accounts.commission(" Bea ", PIN, code).name == "Bea"


@pytest.mark.parametrize("content", ["", "[]", "{}", '{"salt": "x", "hash": ""}', '{"salt": 1, "hash": 2}'])
def test_a_damaged_code_is_said(tmp_path: Path, content: str) -> None:
    keys = tmp_path / "keys"
    make_code(keys)
    (keys / "commissioning.json").write_text(content)
    with pytest.raises(LoginError, match="make a new code"):
        Accounts(tmp_path, keys).commission("Ada", PIN, "1")


def test_the_command_makes_a_code_that_works_once(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "station.toml"
    path.write_text(GOOD)
    assert main(["commission", "-c", str(path)]) == 0
    code = capsys.readouterr().out.splitlines()[0].removeprefix("commissioning code: ")
    accounts = Accounts(tmp_path, keys_folder(path))
    assert accounts.commission("Ada", PIN, code).level is Level.ADMIN
    for place in keys_folder(path).iterdir():
        assert not place.stat().st_mode & 0o077
    assert [place.name for place in keys_folder(path).iterdir()] == [KEY]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
def test_a_code_that_root_makes_belongs_to_the_account_of_the_engine(tmp_path: Path) -> None:
    """It was the usual way, and then the engine could not read it."""
    path = tmp_path / "station.toml"
    path.write_text(GOOD)
    archive = load(path).archive.folder
    archive.mkdir(parents=True, exist_ok=True)
    os.chown(archive, 65534, 65534)
    try:
        assert main(["commission", "-c", str(path)]) == 0
        for place in (keys_folder(path), *keys_folder(path).iterdir()):
            assert (place.stat().st_uid, place.stat().st_mode & 0o077) == (65534, 0)
    finally:
        archive.rmdir()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
@pytest.mark.parametrize("linked", ["folder", "file", "hard"])
def test_root_gives_no_files_away_that_the_account_of_the_engine_has_linked(
    tmp_path: Path, linked: str
) -> None:
    """The folder around the keys may belong to that account."""
    path, secret = tmp_path / "station.toml", tmp_path / "etc" / "shadow"
    path.write_text(f'{GOOD}[archive]\nfolder = "{tmp_path}/own"\n')
    secret.parent.mkdir()
    secret.write_text("secret")
    archive, keys = load(path).archive.folder, keys_folder(path)
    archive.mkdir(parents=True, exist_ok=True)
    os.chown(archive, 65534, 65534)
    if linked == "folder":
        keys.symlink_to(secret.parent)
    else:
        keys.mkdir(mode=0o700)
        make_link = os.symlink if linked == "file" else os.link
        make_link(secret, keys / "shadow")
    assert main(["commission", "-c", str(path)]) == (2 if linked == "folder" else 0)
    assert secret.stat().st_uid == 0
    assert [file.name for file in secret.parent.iterdir()] == ["shadow"]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give files away")
def test_root_gives_the_keys_to_the_owner_of_the_settings_before_there_is_an_archive(tmp_path: Path) -> None:
    path = tmp_path / "station.toml"
    path.write_text(f'{GOOD}[archive]\nfolder = "{tmp_path}/own"\n')
    os.chown(path, 65534, 65534)
    assert main(["commission", "-c", str(path)]) == 0
    assert {place.stat().st_uid for place in (keys_folder(path), *keys_folder(path).iterdir())} == {65534}

"""The engine alone decides who may do what, answers each request once, and notes what it does."""

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.archive.writer import Archive
from station.channel.requests import (
    TOO_OLD,
    Acknowledge,
    Answer,
    Changed,
    ChangeSettings,
    CheckMaster,
    EndService,
    GiveReview,
    HoldService,
    LogIn,
    LogOut,
    Message,
    ReloadSettings,
    RemoveUser,
    Request,
    ResetCounts,
    SaveUser,
    StayLoggedIn,
    TakeTestImage,
)
from station.domain import Frame, Image, Origin
from station.engine import orders
from station.engine.logins import WINDOW_LOST_S, Logins
from station.engine.operator_desk import FRESH_S, OTHER_IN_SERVICE, OperatorDesk, Reply
from station.engine.rights import CHANGES, NEEDED, check, needed
from station.engine.service_mode import LEASE_S
from station.errors import LoginError, RecordError, SettingsError
from station.files.private import write_private
from station.journal.accounts import NO_USERS, WRONG, WRONG_CODE, Accounts
from station.journal.commissioning import make_code
from station.journal.journal import Entry, Kind, entries
from station.journal.journal_writer import append
from station.journal.pins import KEY
from station.journal.reviews import Opinion, reviews
from station.journal.users import Level, User, users
from station.plc.map.registers import Status
from station.plc.port import Counts
from station.records import Part
from station.settings.model import ArchiveSettings
from tests.parts import label_with, nok_inspection, provenance

IDLE_S = 600.0
PEOPLE = {Level.OPERATOR: "Bob", Level.SETTER: "Sam", Level.QUALITY: "Quentin", Level.ADMIN: "Ada"}
PIN = "123456"
CAMERA = ChangeSettings((Changed(("camera", "gain_db"), 1.0),), "more light")
LIMITS = ChangeSettings(
    (Changed(("recipes", "1", "model", "limits", "hole", "threshold"), 0.5),), "fewer holes"
)
ONE_OF_EACH: tuple[Request, ...] = (
    LogIn("Ada", PIN),
    StayLoggedIn(True),
    LogOut(),
    SaveUser("Eve", Level.OPERATOR, "9999"),
    RemoveUser("Bob"),
    CAMERA,
    LIMITS,
    ReloadSettings(),
    Acknowledge(5),
    GiveReview(1, Opinion.FALSE_CALL),
    TakeTestImage(),
    CheckMaster("M"),
    HoldService(),
    EndService(),
    ResetCounts(),
)


@dataclass
class Desk:
    """The engine's desk with its clock in hand."""

    folder: Path
    now_s: float = 1000.0
    given: list[orders.Order] = field(default_factory=list)
    changes: list[tuple[str, Message]] = field(default_factory=list)

    def __post_init__(self) -> None:
        logins = Logins(lambda: IDLE_S)
        self.desk = OperatorDesk(
            self.folder,
            logins,
            Accounts(self.folder, self.folder / "keys", clock=lambda: self.now_s),
            hand_over=self.given.append,
            counts=lambda: Counts(3, 1, 0),
            clock=lambda: self.now_s,
        )

    def ask(self, request: Request, token: str = "", age_s: float = 0.0) -> Answer:
        answers: list[Answer] = []

        def later(who: str, message: Message, reply: Reply) -> None:
            self.changes.append((who, message))
            reply(Answer(message.request_id, logged_in=True))

        self.desk.handle(Message(7, self.now_s - age_s, request, token), answers.append, later)
        (answer,) = answers
        assert answer.request_id == 7
        return answer

    def log_in(self, level: Level, token: str = "") -> str:
        answer = self.ask(LogIn(PEOPLE[level], PIN), token)
        assert (answer.refusal, answer.name, answer.level) == ("", PEOPLE[level], level)
        return answer.token

    def wait(self, seconds: float) -> None:
        self.now_s += seconds
        self.desk.tick()

    def noted(self, *kinds: Kind) -> list[Entry]:
        return entries(self.folder, kinds, newest_first=False)


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, bytes]:
    """Return a journal with one user of each level; PINs are slow to hash."""
    folder, keys = tmp_path_factory.mktemp("people"), tmp_path_factory.mktemp("keys")
    accounts = Accounts(folder, keys)
    for level in sorted(Level, reverse=True):
        accounts.save_user(PEOPLE[level], level=level, pin=PIN, by="Ada")
    append(folder, Kind.ALARM, "station", "16#3002")

    with closing(sqlite3.connect(folder / "journal.sqlite")) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    return (folder / "journal.sqlite").read_bytes(), (keys / KEY).read_bytes()


@pytest.fixture
def desk(tmp_path: Path, people: tuple[bytes, bytes], frames: dict[str, Image]) -> Iterator[Desk]:
    archive = Archive(ArchiveSettings(folder=tmp_path, min_free_mb=1, thin_free_mb=1, warn_free_mb=1))
    frame = Frame(frames[label_with("hole")["frame"]], datetime.now(UTC), "cam", Origin.SIMULATED)
    archive.commit(
        archive.begin(frame),
        nok_inspection(),
        Part("A", 1, Origin.SIMULATED),
        provenance(),
        now=frame.grabbed_at,
    )
    archive.close()
    (tmp_path / "journal.sqlite").write_bytes(people[0])
    write_private(tmp_path / "keys" / KEY, people[1])
    return Desk(tmp_path)


def test_every_kind_of_request_has_its_place_in_the_table() -> None:
    assert set(NEEDED) == set(get_args(Request)) == {type(request) for request in ONE_OF_EACH}


@given(st.sampled_from(ONE_OF_EACH), st.sampled_from([None, *Level]))
def test_a_request_is_allowed_from_its_level_on(request: Request, level: Level | None) -> None:
    user, least = None if level is None else User("Eve", level), needed(request)
    if least is None or (level is not None and level >= least):
        check(request, user)
    else:
        with pytest.raises(LoginError, match=f"a login of the level {least.name.lower()} is needed"):
            check(request, user)


@given(st.lists(st.sampled_from([*CHANGES, "plc", "archive"]), min_size=1, max_size=4))
def test_a_change_of_several_settings_needs_the_highest_of_their_levels(sections: list[str]) -> None:
    change = ChangeSettings(tuple(Changed((name, "x"), 1.0) for name in sections), "because")
    if set(sections) <= set(CHANGES):
        assert needed(change) is max(CHANGES[name] for name in sections)
    else:
        with pytest.raises(SettingsError, match="cannot be changed at the station"):
            needed(change)


@pytest.mark.parametrize("request_", ONE_OF_EACH[1:], ids=lambda r: r.type)
def test_whoever_asks_is_answered_and_below_the_level_nothing_happens(desk: Desk, request_: Request) -> None:
    least = needed(request_)
    assert least is not None
    refusal = f"a login of the level {least.name.lower()} is needed"
    for level in [None, *Level]:
        token = "" if level is None else desk.log_in(level)
        before, done_before = len(desk.noted()), len(desk.given) + len(desk.changes)
        answer = desk.ask(request_, token)
        if level is None or level < least:
            assert answer.refusal == refusal
            assert (len(desk.noted()), len(desk.given) + len(desk.changes)) == (before, done_before)
        else:
            assert answer.done or answer.refusal == "the second review needs the level quality"
        desk.ask(LogOut(), token)
    assert isinstance(request_, RemoveUser) is ("Bob" not in {user.name for user in users(desk.folder)})


def test_a_token_that_is_not_from_the_engine_is_worth_nothing(desk: Desk) -> None:
    desk.log_in(Level.ADMIN)
    for token in ("", "Ada", "0" * 32):
        answer = desk.ask(ResetCounts(), token)
        assert (answer.logged_in, answer.refusal) == (False, "a login of the level setter is needed")


def test_an_old_request_is_answered_but_not_carried_out(desk: Desk) -> None:
    token = desk.log_in(Level.SETTER)
    assert desk.ask(ResetCounts(), token, FRESH_S + 0.1).refusal == TOO_OLD
    assert desk.given == []


def test_a_fault_in_one_request_is_answered_and_ends_nothing(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    token = desk.log_in(Level.SETTER)

    def broken(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    with monkeypatch.context() as patched:
        patched.setattr("station.engine.operator_desk.append", broken)
        assert "internal error" in desk.ask(ResetCounts(), token).refusal
    assert desk.ask(ResetCounts(), token).done
    assert desk.given == [orders.ResetCounts("Sam")]


def test_what_cannot_be_noted_is_not_done(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    token = desk.log_in(Level.SETTER)

    def full(*_: object, **__: object) -> None:
        raise RecordError("the disk is full")

    monkeypatch.setattr("station.engine.operator_desk.append", full)
    for request in (ResetCounts(), TakeTestImage(), CheckMaster("M"), HoldService(), Acknowledge(5)):
        assert desk.ask(request, token).refusal == "the disk is full"
    assert desk.given == []


def test_only_a_commissioning_code_makes_the_first_administrator(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    code = make_code(tmp_path / "keys")
    assert desk.ask(LogIn("Ada", PIN)).refusal == NO_USERS
    assert desk.ask(LogIn("Ada", PIN, "1234-5678-9012")).refusal == WRONG_CODE
    assert desk.ask(LogIn("Ada", "1234", code)).refusal == "a PIN of 6 to 12 digits is needed"
    assert users(tmp_path) == []
    assert desk.ask(LogIn(" Ada ", PIN, code)).level is Level.ADMIN
    assert desk.ask(LogIn("Eve", PIN, code)).refusal == WRONG_CODE
    assert desk.ask(LogIn("Eve", PIN)).refusal == WRONG
    assert users(tmp_path) == [User("Ada", Level.ADMIN)]
    (tmp_path / "journal.sqlite").unlink()
    assert desk.ask(LogIn("Eve", PIN)).refusal == NO_USERS, "a deleted journal opens no door"


def test_five_wrong_pins_lock_whatever_window_they_come_from(desk: Desk) -> None:
    for _ in range(5):
        assert desk.ask(LogIn("Sam", "0000")).refusal == "unknown name or wrong PIN"
    answer = desk.ask(LogIn("Sam", PIN))
    assert "is locked for" in answer.refusal
    assert 50 < answer.locked_s <= 60
    assert answer.token == ""
    assert desk.log_in(Level.ADMIN)


def test_who_touches_nothing_is_logged_out_by_the_engine(desk: Desk) -> None:
    token = desk.log_in(Level.SETTER)
    for _ in range(int(IDLE_S // 10)):
        desk.wait(10)
        assert desk.ask(StayLoggedIn(False), token).done
        assert desk.ask(HoldService(), token).done, "what renews automatically is not a touch"
    desk.wait(10)
    assert not desk.ask(StayLoggedIn(True), token).logged_in
    assert [(e.who, e.reason) for e in desk.noted(Kind.LOGOUT)] == [("Sam", "idle")]
    assert desk.given[-1] == orders.Service("Sam", ended=True)


def test_who_touches_something_stays(desk: Desk) -> None:
    token = desk.log_in(Level.SETTER)
    for _ in range(int(IDLE_S // 10) + 5):
        desk.wait(10)
        assert desk.ask(StayLoggedIn(True), token).done
    assert desk.noted(Kind.LOGOUT) == []


def test_a_window_that_is_gone_leaves_nobody_logged_in(desk: Desk) -> None:
    token = desk.log_in(Level.SETTER)
    desk.ask(HoldService(), token)
    desk.wait(LEASE_S + 0.1)
    assert desk.given[-1] == orders.Service("Sam", ended=True)
    desk.wait(WINDOW_LOST_S)
    assert [(e.who, e.reason) for e in desk.noted(Kind.LOGOUT)] == [("Sam", "window closed")]
    assert desk.ask(ResetCounts(), token).refusal == "a login of the level setter is needed"


def test_who_logs_in_ends_what_the_one_before_was_doing(desk: Desk) -> None:
    token = desk.log_in(Level.SETTER)
    desk.ask(HoldService(bit=int(Status.OK)), token)
    second = desk.log_in(Level.OPERATOR, token)
    assert desk.given[-1] == orders.Service("Sam", ended=True)
    assert [(e.who, e.reason) for e in desk.noted(Kind.LOGOUT)] == [("Sam", "another user logged in")]
    assert not desk.ask(StayLoggedIn(True), token).logged_in
    assert desk.ask(HoldService(), second).refusal == "a login of the level setter is needed"


def test_whatever_is_done_by_hand_is_in_the_journal(desk: Desk) -> None:
    token = desk.log_in(Level.SETTER)
    for request in (
        TakeTestImage(),
        CheckMaster("MASTER-1"),
        HoldService(),
        HoldService(look=True),
        HoldService(bit=int(Status.READY)),
        ResetCounts(),
        EndService(),
    ):
        assert desk.ask(request, token).done
    assert [(e.who, e.subject, e.before, e.after) for e in desk.noted(Kind.SERVICE)] == [
        ("Sam", "test image", "", ""),
        ("Sam", "test image", "", "MASTER-1"),
        ("Sam", "service mode", "", "begins"),
        ("Sam", "setup images", "", "begins"),
        ("Sam", "bit by hand", "–", "READY"),
        ("Sam", "setup images", "", "over"),
        ("Sam", "counters", "OK 3, NOK 1, ERROR 0", "0"),
        ("Sam", "service mode", "begins", "over"),
    ]
    assert desk.given == [
        orders.TestImage(),
        orders.TestImage("MASTER-1"),
        orders.Service("Sam"),
        orders.Service("Sam", setup_images=True),
        orders.Service("Sam", bit=int(Status.READY)),
        orders.ResetCounts("Sam"),
        orders.Service("Sam", ended=True),
    ]


def test_nobody_takes_service_mode_from_another(desk: Desk) -> None:
    first, second = desk.log_in(Level.SETTER), desk.log_in(Level.ADMIN)
    assert desk.ask(HoldService(), first).done
    assert desk.ask(HoldService(), second).refusal == OTHER_IN_SERVICE
    assert desk.ask(EndService(), second).done
    assert desk.given == [orders.Service("Sam")], "it is not hers to end"
    assert desk.ask(HoldService(bit=3), first).refusal == "3 is not a single bit of STATUS"
    desk.ask(LogOut(), first)
    assert desk.ask(HoldService(), second).done


def test_an_alarm_is_acknowledged_once_it_is_in_the_journal(desk: Desk) -> None:
    token = desk.log_in(Level.OPERATOR)
    (alarm,) = desk.noted(Kind.ALARM)
    assert desk.ask(Acknowledge(alarm.number), token).done
    assert desk.ask(Acknowledge(alarm.number + 1), token).refusal == "there is no such alarm"
    assert [(e.who, e.subject) for e in desk.noted(Kind.ALARM_SEEN)] == [("Bob", str(alarm.number))]


def test_a_review_is_given_to_the_verdict_on_record(desk: Desk) -> None:
    bob, sam, quentin = (desk.log_in(level) for level in (Level.OPERATOR, Level.SETTER, Level.QUALITY))
    assert desk.ask(GiveReview(99, Opinion.RIGHT), bob).refusal == "part 99 does not exist in the archive"
    refusal = "the opinion 'missed defect' does not fit the verdict NOK"
    assert desk.ask(GiveReview(1, Opinion.MISSED), bob).refusal == refusal
    assert desk.ask(GiveReview(1, Opinion.FALSE_CALL, "soot "), bob).done
    assert (
        desk.ask(GiveReview(1, Opinion.FALSE_CALL), sam).refusal
        == "the second review needs the level quality"
    )
    assert desk.ask(GiveReview(1, Opinion.FALSE_CALL), quentin).done
    assert reviews(desk.folder)[1].agreed is Opinion.FALSE_CALL
    assert desk.noted(Kind.REVIEW)[0].reason == "soot"


def test_another_pin_or_level_ends_the_logins_of_that_user(desk: Desk) -> None:
    ada, sam = desk.log_in(Level.ADMIN), desk.log_in(Level.SETTER)
    assert desk.ask(SaveUser("Sam", Level.OPERATOR, "4321"), ada).done
    assert desk.ask(ResetCounts(), sam).refusal == "a login of the level setter is needed"
    assert desk.ask(StayLoggedIn(True), ada).logged_in
    assert desk.ask(RemoveUser("Ada"), ada).refusal == "at least one administrator is needed"
    assert [e.reason for e in desk.noted(Kind.LOGOUT)] == ["user changed"]


def test_an_engine_that_stops_logs_out_all(desk: Desk) -> None:
    for level in Level:
        desk.log_in(level)
    desk.desk.close()
    assert [e.reason for e in desk.noted(Kind.LOGOUT)] == ["engine stopped"] * len(Level)


@given(st.lists(st.tuples(st.floats(0, 40), st.booleans()), max_size=30))
def test_a_login_lasts_while_its_window_is_heard_and_touched(steps: list[tuple[float, bool]]) -> None:
    logins, user, now = Logins(lambda: 60.0), User("Sam", Level.SETTER), 0.0
    token = logins.begin(user, now)
    heard = touched = now
    for wait_s, touch in steps:
        now += wait_s
        lasts = now - heard <= WINDOW_LOST_S and now - touched <= 60.0
        assert (logins.user(token, now) is user) is lasts
        assert bool(logins.ended(now)) is not lasts
        logins.renew(token, touch, now)
        heard, touched = (now, now if touch else touched) if lasts else (heard, touched)

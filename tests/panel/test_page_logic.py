"""What pages decide, without a window: login, waiting requests, search, what-if, masters, the lamp's foot."""

import subprocess
import sys
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from station.archive.reader import Row
from station.archive.schema import open_index
from station.channel.requests import MIN_REASON, Answer
from station.journal.reviews import Opinion, Review, State
from station.journal.users import Level, User
from station.panel.pages.history.exports import Written, write_reviewed, write_table
from station.panel.pages.history.search import FOUND, MIN_SCORE, SEARCHED, TO_CONFIRM, Search
from station.panel.pages.setup.login_view import Notice, login_view, notice
from station.panel.pages.setup.masters_table import MasterState, master_rows
from station.panel.pages.setup.what_if_state import Missing, Values, WhatIfState
from station.panel.session.lamp import foot
from station.panel.session.login_state import LoginState
from station.panel.session.pending import NO_ANSWER_S, NO_CONNECTION, SILENCE_S, Pending
from tests.conftest import ROOT
from tests.panel.made import part
from tests.parts import ok_inspection

NOW = datetime(2026, 11, 27, 12, tzinfo=UTC)
PURE = (
    "station.panel.pages.history.exports",
    "station.panel.pages.history.search",
    "station.panel.pages.replay.judging",
    "station.panel.session.lamp",
    "station.panel.session.login_state",
    "station.panel.session.pending",
    "station.panel.pages.setup.login_view",
    "station.panel.pages.setup.masters_table",
    "station.panel.pages.setup.what_if_state",
)


def row(
    number: int = 1, verdict: str = "NOK", purpose: str = "part", serial: str = "M", at: datetime = NOW
) -> Row:
    return Row(
        inspection_id=number,
        serial=serial,
        trigger_id=1,
        grabbed_at=at.isoformat(),
        verdict=verdict,
        reason=None,
        worst_score=0.9,
        frame_file=None,
        frame_state="kept",
        record_file="r.json",
        record_sha256="",
        shown_to_plc=True,
        purpose=purpose,
        recipe=1,
        chain=None,
    )


def test_what_pages_decide_needs_no_qt() -> None:
    code = (
        f"import sys, importlib\nfor name in {PURE}: importlib.import_module(name)\n"
        "assert 'PySide6' not in sys.modules\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stderr


# a login is what the engine reports


@given(st.sampled_from(list(Level)), st.sampled_from(list(Level)))
def test_a_login_has_the_rights_of_its_level_until_the_engine_ends_it(level: Level, asked: Level) -> None:
    state = LoginState()
    assert not state.may(Level.OPERATOR)
    assert not state.begin(Answer(1, "unknown name or wrong PIN"))
    assert state.begin(Answer(2, logged_in=True, token="t", name="Ada", level=level))
    assert state.may(asked) is (level >= asked)
    assert not state.is_ended_by("t", Answer(3, logged_in=True))
    assert not state.is_ended_by("t", Answer(3, NO_CONNECTION)), "the engine may come back"
    assert not state.is_ended_by("of the login before", Answer(3, "a login is needed"))
    assert state.is_ended_by("t", Answer(3, "a login is needed"))
    assert state.end()
    assert not state.end()
    assert not state.may(Level.OPERATOR)
    assert not state.is_ended_by("", Answer(4, "a login is needed")), "there is none that could end"


def test_a_touch_is_reported_once() -> None:
    state = LoginState()
    state.touched()
    assert not state.take_touched(), "nobody is logged in"
    state.begin(Answer(1, logged_in=True, token="t", name="Ada", level=Level.ADMIN))
    state.touched()
    assert [state.take_touched(), state.take_touched()] == [True, False]


def test_the_login_page_offers_the_users_of_the_station() -> None:
    assert login_view([], "").first
    known = [User("Ada", Level.ADMIN), User("Bob", Level.OPERATOR)]
    assert login_view(known, "").chosen == "Ada"
    assert login_view(known, "Bo").chosen == "Bo"
    assert login_view(known, "").names == ("Ada", "Bob")
    assert notice(Answer(1, logged_in=True)) is Notice.NOTHING
    assert notice(Answer(1, "Ada is locked for 43 s more after 5 wrong PINs", locked_s=43.0)) is Notice.LOCKED
    assert notice(Answer(1, "unknown name or wrong PIN")) is Notice.REFUSED


# each request has one answer


@given(st.lists(st.sampled_from(["ask", "answer", "wait"]), max_size=40))
def test_each_request_is_answered_once_by_the_engine_or_given_up(steps: list[str]) -> None:
    pending, now, came = Pending(), 0.0, dict[int, int]()
    waiting: list[int] = []
    for step in steps:
        if step == "ask":
            number = pending.begin(
                lambda answer: came.__setitem__(answer.request_id, came.get(answer.request_id, 0) + 1), now
            )
            waiting.append(number)
        elif step == "answer" and waiting:
            answer = Answer(waiting.pop(0))
            then = pending.answered(answer, now)
            assert then is not None
            then(answer)
            assert pending.answered(answer, now) is None, "an answer that comes twice is used once"
        else:
            now += 1.0
        for number in pending.lost(now):
            then = pending.given_up(number)
            assert then is not None
            then(Answer(number, NO_CONNECTION))
            waiting.remove(number)
    now += SILENCE_S + 1
    assert pending.lost(now) == waiting
    assert all(count == 1 for count in came.values())


def test_a_change_may_last_as_long_as_the_engine_answers_others() -> None:
    pending = Pending()
    change = pending.begin(lambda _: None, 0.0)
    for second in range(60):
        renewal = pending.begin(lambda _: None, float(second))
        pending.answered(Answer(renewal), float(second))
        assert pending.lost(float(second)) == []
    assert pending.lost(59.0 + SILENCE_S + 0.1) == [change]


SECONDS = st.integers(1, 6400).map(lambda part: part / 64)  # sums of them are exact


@given(
    st.lists(st.integers(0, round(64 * SILENCE_S)).map(lambda part: part / 64), min_size=1, max_size=30),
    SECONDS,
)
def test_a_busy_engine_whose_events_come_may_answer_late_but_not_never(
    gaps: list[float], more_s: float
) -> None:
    pending, now_s = Pending(), 0.0
    number = pending.begin(lambda _: None, now_s)
    for gap_s in gaps:
        now_s += gap_s
        assert pending.lost(now_s) == ([number] if now_s > NO_ANSWER_S else [])
        pending.heard(now_s)
    silent_or_mute = more_s > SILENCE_S or now_s + more_s > NO_ANSWER_S
    assert pending.lost(now_s + more_s) == ([number] if silent_or_mute else [])


# search


def test_a_search_queries_the_archive_for_what_the_fields_describe() -> None:
    anything = Search().query(NOW)
    assert (anything.serial, anything.since, anything.until, anything.limit) == (None, None, None, FOUND)
    query = Search(serial=" A* ", hours=8, segment=3, state=str(State.ONE)).query(NOW)
    assert (query.serial, query.since, query.min_score) == ("A*", NOW - timedelta(hours=8), MIN_SCORE)
    assert query.limit == SEARCHED, "the state of a review is not in the index"
    between = Search(since=NOW - timedelta(days=2), until=NOW - timedelta(days=1)).query(NOW)
    assert (between.since, between.until) == (NOW - timedelta(days=2), NOW - timedelta(days=1))


OPINIONS = st.dictionaries(
    st.sampled_from(["Ada", "Bob", "Cy"]), st.sampled_from([Opinion.RIGHT, Opinion.FALSE_CALL])
)


@given(OPINIONS, st.sampled_from(["OK", "NOK", "ERROR"]), st.sampled_from(["part", "golden", "test"]))
def test_every_part_has_one_state_and_only_nok_parts_wait_to_be_confirmed(
    opinions: dict[str, Opinion], verdict: str, purpose: str
) -> None:
    review, found = Review(opinions), row(verdict=verdict, purpose=purpose)
    assert [Search(state=str(state)).fits(found, review) for state in State].count(True) == 1
    assert Search().fits(found, review)
    waits = Search(state=TO_CONFIRM).fits(found, review)
    assert waits is (verdict == "NOK" and purpose == "part" and review.state is not State.AGREED)


# masters


@pytest.mark.parametrize(
    ("verdict", "age_h", "due_h", "state"),
    [
        (None, 0, None, MasterState.UNKNOWN),
        (None, 0, 24, MasterState.DUE),
        ("NOK", 1, 24, MasterState.RIGHT),
        ("NOK", 25, 24, MasterState.DUE),
        ("NOK", 999, None, MasterState.RIGHT),
        ("OK", 25, 24, MasterState.WRONG),
        ("ERROR", 1, None, MasterState.WRONG),
    ],
)
def test_the_state_of_a_master(
    verdict: str | None, age_h: float, due_h: float | None, state: MasterState
) -> None:
    at = NOW - timedelta(hours=age_h)
    older = row(1, "ERROR", "golden", at=at - timedelta(hours=1))
    checks = [] if verdict is None else [row(2, verdict, "golden", at=at), older]
    (master,) = master_rows({"M": "NOK"}, due_h, checks, NOW)
    assert (master.state, master.found) == (state, verdict)
    assert master.due == (None if due_h is None or verdict is None else at + timedelta(hours=due_h))


# other limits


USED = Values(1, {"limits.hole.threshold": 0.4612345678, "min_sharpness": 0.01})
LIMITS = st.builds(
    Values,
    st.just(1),
    st.fixed_dictionaries({"limits.hole.threshold": st.floats(0.01, 0.99), "min_sharpness": st.just(0.01)}),
)


@given(LIMITS, st.one_of(st.none(), LIMITS), st.text(max_size=8), st.booleans(), st.booleans())
def test_limits_are_saved_only_with_the_right_level_after_a_what_if_and_with_a_reason(
    values: Values, asked: Values | None, reason: str, allowed: bool, waiting: bool
) -> None:
    state = WhatIfState()
    state.in_use, state.asked = USED, asked
    free = state.missing(values, reason, allowed, waiting) is Missing.NOTHING
    enough = len(reason.strip()) >= MIN_REASON
    assert free is (allowed and not waiting and enough and values == asked and values != USED.rounded())


def test_rounding_in_the_fields_is_not_a_change() -> None:
    state = WhatIfState()
    assert not state.changed(USED), "nothing is known to be in use"
    state.in_use = USED
    assert not state.changed(USED.rounded())
    assert state.changed(replace(USED.rounded(), segments={3: 0.6}))
    assert not state.changed(None)


# the lamp


@pytest.mark.parametrize(
    ("age_s", "shown"),
    [(1, "S1 · 1 s"), (119, "S1 · 119 s"), (121, "S1 · 2 min"), (8000, "S1 · 2 h"), (2e5, "S1 · 2 d")],
)
def test_the_line_below_the_lamp_tells_the_age(age_s: float, shown: str) -> None:
    assert foot(part(ok_inspection(), at_s=100.0), 100.0 + age_s) == shown
    assert foot(None, 5.0) == ""


# exports


def test_parts_are_written_as_a_table_unless_the_work_is_cancelled(tmp_path: Path) -> None:
    folder, target = tmp_path / "records", tmp_path / "parts.csv"
    folder.mkdir()
    open_index(folder).close()
    assert write_table(folder, (1, 2), target, lambda done, total: False) is None
    assert write_reviewed(folder, tmp_path / "reviewed", lambda done, total: True) == Written(
        tmp_path / "reviewed", 0, 0
    )
    assert not target.exists()
    assert write_table(folder, (), target, lambda done, total: True) == Written(target, 0, 0)
    assert len(target.read_text().splitlines()) <= 1, "no part, so at most the head"

"""Rights and changes in the window: the engine decides, and what one user typed is gone for the next."""

import time
from datetime import UTC, datetime
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from station.archive.writer import Archive
from station.channel.preview import make_preview
from station.channel.request_socket import Incoming, RequestServer
from station.channel.requests import Answer, Changed, HoldService, LogIn, Message
from station.channel.zeromq import Publisher
from station.domain import Frame, Image, Origin
from station.engine import orders
from station.engine.alarm_log import AlarmLog
from station.inspection.loading import prepare
from station.journal.journal import Entry, Kind, entries
from station.journal.journal_writer import append
from station.journal.users import Level
from station.panel.pages.alarms.page import AlarmsPage
from station.panel.pages.line.page import LinePage
from station.panel.pages.live.page import LivePage
from station.panel.pages.setup.page import SetupPage
from station.panel.pages.setup.recipe import RecipePage
from station.panel.pages.statistics.page import StatisticsPage
from station.panel.pages.table import PageKey
from station.panel.session.pending import NO_CONNECTION
from station.panel.session.session import Session
from station.panel.window import Window
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Status
from station.records import Part
from station.settings import adjustments
from station.settings.file import load
from station.settings.model import ChannelSettings
from tests.desk import PIN, Desk
from tests.panel.made import log_in, part, status
from tests.parts import label_with, nok_inspection, ok_inspection

REASON = "trial of the threshold"
HOLE = ("recipes", "1", "model", "limits", "hole", "threshold")


def noted(session: Session, *kinds: Kind) -> list[Entry]:
    return entries(session.received.folder, kinds)


def recipe_page(window: Window) -> RecipePage:
    window.go(PageKey.SETUP)
    assert isinstance(window.page, SetupPage)
    window.page.show_tab(window.page.recipe)
    return window.page.recipe


def hold(session: Session, qtbot: QtBot, request: HoldService) -> None:
    """Service mode, granted by the engine."""
    session.service.hold(request)
    qtbot.waitUntil(lambda: session.service.held == request, timeout=5000)


def test_who_logs_in_ends_what_the_one_before_was_doing(window: Window, desk: Desk, qtbot: QtBot) -> None:
    session, refused = window.session, list[str]()
    session.service.refused.connect(refused.append)
    log_in(session, desk, qtbot, "Ada", Level.SETTER)
    hold(session, qtbot, HoldService(bit=int(Status.OK)))
    log_in(session, desk, qtbot, "Bob", Level.OPERATOR)
    assert session.service.held is None
    qtbot.waitUntil(lambda: desk.given[-1] == orders.Service("Ada", ended=True), timeout=5000)
    assert [(e.who, e.kind) for e in noted(session, Kind.LOGOUT)] == [("Ada", Kind.LOGOUT)]
    session.service.hold(HoldService())
    qtbot.waitUntil(lambda: refused == ["a login of the level setter is needed"], timeout=5000)
    assert session.service.held is None


def test_the_engine_ends_a_login_and_the_window_says_so(window: Window, desk: Desk, qtbot: QtBot) -> None:
    session = window.session
    log_in(session, desk, qtbot, "Ada", Level.SETTER)
    hold(session, qtbot, HoldService())
    desk.knows("Ada", Level.OPERATOR)
    for token in desk.requests._desk._logins.tokens("Ada"):
        desk.requests._desk._logins.end(token)
    qtbot.waitUntil(lambda: session.account.user is None, timeout=5000)
    assert session.service.held is None
    assert window.user.text() == "Log in"


def test_without_an_engine_nobody_logs_in_and_a_message_says_why(window: Window, qtbot: QtBot) -> None:
    window.go(PageKey.SETUP)
    page = window.page
    assert isinstance(page, SetupPage)
    page.login.name.setEditText("Ada")
    page.login.pin.setText(PIN)
    page.login.log_in.click()
    qtbot.waitUntil(lambda: page.login.problem.text() == NO_CONNECTION, timeout=10_000)
    assert page.login.log_in.isEnabled()
    assert window.session.account.user is None


def test_buttons_wait_for_the_engine_and_a_message_says_when_it_is_gone(
    window: Window, desk: Desk, qtbot: QtBot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("station.panel.session.pending.SILENCE_S", 0.5)
    log_in(window.session, desk, qtbot, "Ada", Level.SETTER)
    window.go(PageKey.STATISTICS)
    page = window.page
    assert isinstance(page, StatisticsPage)
    page.zero.click()
    assert not page.zero.isEnabled()
    qtbot.waitUntil(page.zero.isEnabled, timeout=5000)
    assert desk.given == [orders.ResetCounts("Ada")]
    assert page.problem.text() == ""
    desk.close()
    page.zero.click()
    qtbot.waitUntil(lambda: page.problem.text() == NO_CONNECTION, timeout=5000)
    assert page.zero.isEnabled()
    assert window.session.account.user is not None, "the engine may come back"


def test_a_busy_engine_may_answer_late_and_a_silent_one_is_given_up(
    window: Window,
    publisher: Publisher,
    settings: ChannelSettings,
    qtbot: QtBot,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Under load, a window once gave up an engine whose events it was receiving."""
    monkeypatch.setattr("station.panel.session.pending.SILENCE_S", 0.5)
    server, answers, asked = RequestServer(settings), list[Answer](), list[Incoming]()

    def log_in_is_received() -> bool:
        if answers:  # not connected yet
            answers.clear()
            window.session.account.log_in("Ada", PIN, answers.append)
        publisher.send(status())
        asked.extend(server.received(0.0))
        return bool(asked)

    try:
        window.session.account.log_in("Ada", PIN, answers.append)
        qtbot.waitUntil(log_in_is_received, timeout=10_000)
        end_s = time.monotonic() + 1.5
        while time.monotonic() < end_s:
            publisher.send(status())
            qtbot.wait(50)
        assert answers == [], "events come, so the engine is there"
        sender, message = asked[-1].sender, asked[-1].message
        server.answer(sender, Answer(message.request_id, "unknown name or wrong PIN"))
        qtbot.waitUntil(lambda: [a.refusal for a in answers] == ["unknown name or wrong PIN"], timeout=5000)
        window.session.account.log_in("Ada", PIN, answers.append)
        qtbot.waitUntil(lambda: [a.refusal for a in answers[1:]] == [NO_CONNECTION], timeout=5000)
    finally:
        server.close()


def test_a_request_waits_for_its_connection_while_events_come(
    window: Window, publisher: Publisher, settings: ChannelSettings, qtbot: QtBot
) -> None:
    """Five wrong PINs under load: events had come, but the connection for requests was not there yet."""

    def events_come() -> None:
        publisher.send(status())
        assert window.session.received.engine_there

    qtbot.waitUntil(events_come, timeout=10_000)
    answers, asked = list[Answer](), list[Message]()
    for name in ("Ada", "Bob"):
        window.session.account.log_in(name, PIN, answers.append)
    qtbot.wait(300)
    assert answers == []
    server = RequestServer(settings)

    def requests_are_received() -> bool:
        publisher.send(status())
        for incoming in server.received(0.0):
            asked.append(incoming.message)
            server.answer(incoming.sender, Answer(incoming.message.request_id, "no"))
        return len(answers) == 2

    try:
        qtbot.waitUntil(requests_are_received, timeout=10_000)
    finally:
        server.close()
    assert [message.request.name for message in asked if isinstance(message.request, LogIn)] == ["Ada", "Bob"]
    assert [answer.refusal for answer in answers] == ["no", "no"]


def test_the_bit_set_by_hand_stays_in_sight_in_another_language(
    window: Window, desk: Desk, qtbot: QtBot
) -> None:
    log_in(window.session, desk, qtbot, "Ada", Level.SETTER)
    window.go(PageKey.LINE)
    hold(window.session, qtbot, HoldService(bit=int(Status.BUSY)))
    window.speak("de")
    page = window.page
    assert isinstance(page, LinePage)
    assert page.bits.currentText() == "BUSY"


def test_the_line_page_of_an_absent_engine_claims_nothing(window: Window) -> None:
    window.go(PageKey.LINE)
    page = window.page
    assert isinstance(page, LinePage)
    window.session.bridge.status.emit(status())
    assert page.lamps["STATUS", Status.READY].text() == "● READY"
    window.session.bridge.status.emit(status(at_s=time.monotonic() - 10))
    assert page.lamps["STATUS", Status.READY].text() == "? READY"
    assert page.stale.isVisible()


def test_a_what_if_is_valid_for_its_recipe_its_values_and_its_user_only(
    window: Window, desk: Desk, frames: dict[str, Image], qtbot: QtBot
) -> None:
    session, path = window.session, desk.path
    path.write_text(path.read_text() + "\n[recipes.2.model]\nhole_min_mm = 0.1\n")
    session.received.read_settings()
    loaded, archive = prepare(session.received.settings, 1), Archive(session.received.settings.archive)
    frame = Frame(frames[label_with("OK")["frame"]], datetime.now(UTC), "cam", Origin.SIMULATED)
    archive.commit(
        archive.begin(frame),
        ok_inspection(),
        Part("A", 1, Origin.SIMULATED),
        loaded.provenance,
        now=frame.grabbed_at,
    )
    archive.close()
    log_in(session, desk, qtbot, "Quentin", Level.QUALITY)
    page = recipe_page(window)

    def run_what_if() -> None:
        page.fields["limits.hole.threshold"].edit.setText("0.9")
        page.reason.setText(REASON)
        page.ask.click()
        qtbot.waitUntil(page.save.isEnabled, timeout=10_000)

    run_what_if()
    assert page.message.text().startswith("1 parts")
    page.recipe.setCurrentIndex(1)
    page.fields["limits.hole.threshold"].edit.setText("0.9")
    assert not page.save.isEnabled(), "nobody asked what if of recipe 2"
    assert page.message.text() == ""
    page.recipe.setCurrentIndex(0)
    run_what_if()
    page.fields["limits.hole.threshold"].edit.setText("0.8")
    assert not page.save.isEnabled()
    run_what_if()
    log_in(session, desk, qtbot, "Quirin", Level.QUALITY)
    assert page.reason.text() == ""
    page.reason.setText(REASON)
    assert not page.save.isEnabled(), "it was another one who asked"


def test_a_change_is_waited_for_until_the_station_uses_it_or_says_why_not(
    window: Window, desk: Desk, path: Path, qtbot: QtBot
) -> None:
    session, outcomes = window.session, list[str]()
    session.change.used.connect(lambda: outcomes.append("used"))
    session.change.refused.connect(outcomes.append)
    log_in(session, desk, qtbot, "Quentin", Level.QUALITY)
    desk.turns = False
    session.change.make([Changed(HOLE, 0.9, 0.46)], REASON)
    assert session.change.waiting
    session.change.make([Changed(HOLE, 0.8, 0.46)], REASON)
    qtbot.wait(300)
    assert outcomes == [], "the engine has not yet come to it"
    assert adjustments.read(path) == {}
    desk.turns = True
    qtbot.waitUntil(lambda: outcomes == ["used"], timeout=10_000)
    assert session.received.settings == load(path)
    assert adjustments.read(path) == {"recipes": {"1": {"model": {"limits": {"hole": {"threshold": 0.9}}}}}}
    session.change.make([Changed(HOLE, 7.0, 0.9)], REASON)
    qtbot.waitUntil(lambda: len(outcomes) == 2, timeout=10_000)
    assert outcomes[1] == "limits.hole.threshold: Input should be less than or equal to 1"
    assert adjustments.read(path) == {"recipes": {"1": {"model": {"limits": {"hole": {"threshold": 0.9}}}}}}
    assert [(e.who, e.before, e.after) for e in reversed(noted(session, Kind.SETTING))] == [
        ("Quentin", "0.46", "0.9"),
        ("Quentin", "0.9", "7"),
        ("Quentin", "7", "0.9"),
    ]


def test_the_chosen_alarm_stays_chosen_when_another_comes(window: Window, desk: Desk, qtbot: QtBot) -> None:
    session = window.session
    append(session.received.folder, Kind.ALARM, "station", f"16#{int(Alarm.CAMERA_LOST):04X}")
    window.go(PageKey.ALARMS)
    page = window.page
    assert isinstance(page, AlarmsPage)
    page.table.selectRow(0)
    append(session.received.folder, Kind.ALARM, "station", f"16#{int(Alarm.ARCHIVE_FULL):04X}")
    page.refresh()
    log_in(session, desk, qtbot, "Bob", Level.OPERATOR)
    page.acknowledge.click()
    assert not page.acknowledge.isEnabled()
    qtbot.waitUntil(page.acknowledge.isEnabled, timeout=5000)
    (seen,) = noted(session, Kind.ALARM_SEEN)
    first = noted(session, Kind.ALARM)[-1]
    assert (seen.who, seen.subject) == ("Bob", str(first.number))
    assert "camera" in page.action.text()


def test_what_the_engine_refuses_is_shown_on_the_page(window: Window, desk: Desk, qtbot: QtBot) -> None:
    page = window.page
    assert isinstance(page, LivePage)

    def asked() -> None:
        page.take_test_image()
        qtbot.wait(100)
        assert page.nok_text.text() == "a login of the level operator is needed"

    qtbot.waitUntil(asked, timeout=5000)
    assert desk.given == []


def test_an_answer_to_a_page_that_was_made_again_is_dropped(window: Window, desk: Desk, qtbot: QtBot) -> None:
    log_in(window.session, desk, qtbot, "Ada", Level.SETTER)
    window.go(PageKey.STATISTICS)
    page = window.page
    assert isinstance(page, StatisticsPage)
    page.zero.click()
    window.speak("de")
    qtbot.waitUntil(lambda: desk.given == [orders.ResetCounts("Ada")], timeout=5000)
    qtbot.wait(200)


def test_an_alarm_of_the_run_before_is_cleared_when_it_is_no_longer_active(tmp_path: Path) -> None:
    both = {int(Alarm.CAMERA_LOST), int(Alarm.PLC_SILENT)}
    first = AlarmLog(tmp_path)
    first.set_active(both)
    first.close()
    second = AlarmLog(tmp_path)
    second.set_active({int(Alarm.PLC_SILENT)})
    second.close()
    kinds = [
        (e.kind, int(e.subject[3:], 16))
        for e in entries(tmp_path, (Kind.ALARM, Kind.ALARM_OVER), newest_first=False)
    ]
    assert kinds == [
        *((Kind.ALARM, code) for code in sorted(both)),
        (Kind.ALARM_OVER, int(Alarm.CAMERA_LOST)),
    ]


def test_a_part_that_was_not_recorded_is_never_shown_with_an_image(
    window: Window, frames: dict[str, Image]
) -> None:
    session = window.session
    session.bridge.parts.emit([part(nok_inspection(), 0)])
    session.bridge.preview.emit(make_preview(0, frames[label_with("OK")["frame"]], None, um_per_px=13.0))
    assert session.received.last_nok is not None
    assert session.received.last_nok.preview is None
    assert not session.received.thumbs


def test_an_unreadable_journal_is_logged_and_does_not_stop_the_engine(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "journal.sqlite").write_bytes(b"not a database, " * 100)
    log = AlarmLog(tmp_path)
    log.set_active({int(Alarm.PLC_SILENT)})
    log.close()
    assert "journal.sqlite" in caplog.text

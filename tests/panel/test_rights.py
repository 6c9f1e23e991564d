"""Who may do what in the window, what is noted of it, and that nothing typed or asked by one stays for the next."""

import time
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest
from pytestqt.qtbot import QtBot

from station import adjustments
from station.alarmlog import AlarmLog
from station.archive.journal import Entry, Kind, entries
from station.archive.journal_writer import append
from station.archive.writer import Archive
from station.domain import Frame, Image, Origin
from station.errors import LoginError, SettingsError
from station.panel.alarms.page import AlarmsPage
from station.panel.line.page import LinePage
from station.panel.session import Session
from station.panel.setup.change import change
from station.panel.setup.page import SetupPage
from station.panel.setup.recipe import RecipePage
from station.panel.window import Window
from station.plc.alarms import Alarm
from station.plc.registers import Status
from station.preview import make_preview
from station.recipe import prepare
from station.records import Part
from station.requests import Service
from station.users import Level, User
from tests.panel.made import part, status
from tests.parts import label_with, nok_inspection, ok_inspection

ADA, BOB, QUENTIN = User("Ada", Level.SETTER), User("Bob", Level.OPERATOR), User("Quentin", Level.QUALITY)
REASON = "trial of the threshold"


def told(session: Session, *kinds: Kind) -> list[Entry]:
    return entries(session.folder, kinds)


def recipe_page(window: Window) -> RecipePage:
    window.go(5)
    assert isinstance(window.page, SetupPage)
    window.page.show_tab(window.page.recipe)
    return window.page.recipe


def test_who_logs_in_ends_what_the_one_before_was_doing(window: Window) -> None:
    session = window.session
    session.log_in(ADA)
    session.serve(Service(0.0, "Ada", bit=int(Status.OK)))
    session.log_in(BOB)
    assert session.service is None
    assert [(e.who, e.kind) for e in told(session, Kind.LOGOUT)] == [("Ada", Kind.LOGOUT)]
    with pytest.raises(LoginError, match="setter"):
        session.serve(Service(0.0, "Bob"))
    assert session.service is None


def test_whatever_is_done_by_hand_is_in_the_journal(window: Window) -> None:
    session = window.session
    session.log_in(ADA)
    session.test_picture("MASTER-1")
    session.serve(Service(0.0, "Ada"))
    session.serve(Service(0.0, "Ada", bit=int(Status.READY)))
    session.reset_counts()
    session.end_service()
    assert [(e.who, e.subject, e.before, e.after) for e in reversed(told(session, Kind.SERVICE))] == [
        ("Ada", "test picture", "", "MASTER-1"),
        ("Ada", "service mode", "", "begins"),
        ("Ada", "bit by hand", "–", "READY"),
        ("Ada", "counters", "", "0"),
        ("Ada", "service mode", "begins", "over"),
    ]
    session.log_out("asked to")
    for doing in (session.test_picture, session.reset_counts):
        with pytest.raises(LoginError):
            doing()


def test_the_bit_set_by_hand_stays_in_sight_in_another_language(window: Window) -> None:
    window.session.log_in(ADA)
    window.go(3)
    window.session.serve(Service(0.0, "Ada", bit=int(Status.BUSY)))
    window.speak("de")
    page = window.page
    assert isinstance(page, LinePage)
    assert page.bits.currentText() == "BUSY"


def test_the_line_page_of_an_absent_engine_claims_nothing(window: Window) -> None:
    window.go(3)
    page = window.page
    assert isinstance(page, LinePage)
    window.session._on_status(status())
    assert page._lamps["STATUS", Status.READY].text() == "● READY"
    window.session._on_status(status(at_s=time.monotonic() - 10))
    assert page._lamps["STATUS", Status.READY].text() == "? READY"
    assert page._stale.isVisible()


def test_a_what_if_holds_for_its_recipe_its_values_and_its_user_alone(window: Window, frames: dict[str, Image], qtbot: QtBot) -> None:
    session = window.session
    changed = session.settings.model_copy(update={"recipes": {2: session.settings.recipes.get(2) or _empty(session)}})
    session.settings = changed
    loaded, archive = prepare(changed, 1), Archive(changed.archive)
    frame = Frame(frames[label_with("OK")["frame"]], datetime.now(UTC), "cam", Origin.SIMULATED)
    archive.commit(archive.begin(frame), ok_inspection(), Part("A", 1, Origin.SIMULATED), loaded.provenance, frame.grabbed_at)
    archive.close()
    session.log_in(QUENTIN)
    page = recipe_page(window)

    def asked() -> None:
        page.fields["limits.hole.threshold"].edit.setText("0.9")
        page.reason.setText(REASON)
        page.ask.click()
        qtbot.waitUntil(page.save.isEnabled, timeout=10_000)

    asked()
    assert page.said.text().startswith("1 parts")
    page.recipe.setCurrentIndex(1)
    page.fields["limits.hole.threshold"].edit.setText("0.9")
    assert not page.save.isEnabled(), "nobody asked what if of recipe 2"
    assert page.said.text() == ""
    page.recipe.setCurrentIndex(0)
    asked()
    page.fields["limits.hole.threshold"].edit.setText("0.8")
    assert not page.save.isEnabled()
    asked()
    session.log_in(replace(QUENTIN, name="Quirin"))
    assert page.reason.text() == ""
    page.reason.setText(REASON)
    assert not page.save.isEnabled(), "it was another one who asked"


def _empty(session: Session) -> object:
    field = type(session.settings).model_fields["recipes"].annotation
    return field.__args__[1]()  # type: ignore[union-attr]


def test_a_change_is_asked_for_until_the_station_has_taken_it(window: Window, path: Path) -> None:
    session, heard = window.session, list[str]()
    session.change_used.connect(lambda: heard.append("used"))
    session.change_refused.connect(lambda: heard.append("refused"))
    session._on_status(status())
    session.log_in(QUENTIN)
    place = ("recipes", "1", "model", "limits", "hole", "threshold")
    change(session, Level.QUALITY, {place: (0.46, 0.9)}, REASON)
    session._on_status(status(reloaded_s=time.time() - 60))
    assert heard == [], "the station has not yet read them"
    session._on_status(status(started_s=1.0))
    assert heard == [], "an engine may have read them before they were changed"
    session._on_status(status(reloaded_s=time.time() + 1))
    assert heard == ["used"]
    change(session, Level.QUALITY, {place: (0.9, 0.2)}, REASON)
    alarm = (int(Alarm.SETTINGS_REFUSED),)
    session._on_status(status(alarms=alarm))
    assert heard == ["used"], "an alarm of a change before says nothing of this one"
    session._on_status(status(alarms=alarm, reloaded_s=time.time() + 1))
    assert heard == ["used", "refused"]
    assert adjustments.read(path) == {"recipes": {"1": {"model": {"limits": {"hole": {"threshold": 0.9}}}}}}


def test_two_windows_do_not_wipe_each_other_out(window: Window, path: Path) -> None:
    session = window.session
    session.log_in(QUENTIN)
    with adjustments.editing(path), pytest.raises(SettingsError, match="another window saves"):
        change(session, Level.QUALITY, {("recipes", "1", "quality", "min_sharpness"): (0.01, 0.02)}, REASON)
    change(session, Level.QUALITY, {("recipes", "1", "quality", "min_sharpness"): (0.01, 0.02)}, REASON)
    first = session.change
    assert first is not None
    assert first.undo is not None
    change(session, Level.QUALITY, {("recipes", "1", "model", "limits", "hole", "threshold"): (0.46, 0.5)}, REASON)
    first.undo()
    assert adjustments.read(path) == {"recipes": {"1": {"model": {"limits": {"hole": {"threshold": 0.5}}}}}}


def test_the_chosen_alarm_stays_chosen_when_another_comes(window: Window) -> None:
    session = window.session
    append(session.folder, Kind.ALARM, "station", f"16#{int(Alarm.CAMERA_LOST):04X}")
    window.go(4)
    page = window.page
    assert isinstance(page, AlarmsPage)
    page.table.selectRow(0)
    append(session.folder, Kind.ALARM, "station", f"16#{int(Alarm.ARCHIVE_FULL):04X}")
    page.refresh()
    session.log_in(BOB)
    page.acknowledge.click()
    (seen,) = told(session, Kind.ALARM_SEEN)
    first = told(session, Kind.ALARM)[-1]
    assert (seen.who, seen.subject) == ("Bob", str(first.number))
    assert "camera" in page.action.text()


def test_an_alarm_of_the_run_before_is_over_when_it_is_not_there_any_more(tmp_path: Path) -> None:
    both = {int(Alarm.CAMERA_LOST), int(Alarm.PLC_SILENT)}
    first = AlarmLog(tmp_path)
    first.lasting(both)
    first.close()
    second = AlarmLog(tmp_path)
    second.lasting({int(Alarm.PLC_SILENT)})
    second.close()
    kinds = [(e.kind, int(e.subject[3:], 16)) for e in entries(tmp_path, (Kind.ALARM, Kind.ALARM_OVER), newest_first=False)]
    assert kinds == [*((Kind.ALARM, code) for code in sorted(both)), (Kind.ALARM_OVER, int(Alarm.CAMERA_LOST))]


def test_what_cannot_be_taken_back_just_now_is_taken_back_later(window: Window, path: Path) -> None:
    session = window.session
    session._on_status(status())
    session.log_in(QUENTIN)
    change(session, Level.QUALITY, {("recipes", "1", "model", "limits", "hole", "threshold"): (0.46, 0.9)}, REASON)
    refused = status(alarms=(int(Alarm.SETTINGS_REFUSED),), reloaded_s=time.time() + 1)
    with adjustments.editing(path):
        session._on_status(refused)
    assert adjustments.read(path) != {}
    session._on_status(refused)
    assert adjustments.read(path) == {}


def test_two_changes_that_wait_together_are_taken_back_together(window: Window, path: Path) -> None:
    session = window.session
    session._on_status(status())
    session.log_in(QUENTIN)
    for key, before, after in (("hole", 0.46, 0.9), ("missing_weld", 0.34, 0.9)):
        change(session, Level.QUALITY, {("recipes", "1", "model", "limits", key, "threshold"): (before, after)}, REASON)
    session._on_status(status(alarms=(int(Alarm.SETTINGS_REFUSED),), reloaded_s=time.time() + 1))
    assert adjustments.read(path) == {}


def test_a_part_that_was_not_recorded_is_never_shown_with_a_picture(window: Window, frames: dict[str, Image]) -> None:
    session = window.session
    session._on_parts([part(nok_inspection(), 0)])
    session._on_preview(make_preview(0, frames[label_with("OK")["frame"]], None))
    assert session.last_nok is not None
    assert session.last_nok.preview is None
    assert not session.thumbs


def test_an_unreadable_journal_is_told_and_stops_no_engine(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    (tmp_path / "journal.sqlite").write_bytes(b"not a database, " * 100)
    log = AlarmLog(tmp_path)
    log.lasting({int(Alarm.PLC_SILENT)})
    log.close()
    assert "journal.sqlite" in caplog.text

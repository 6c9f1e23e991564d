"""A day at a running station: parts pass, a NOK part is found and reviewed, a limit is changed, logout."""

import asyncio
import os
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from pytestqt.qtbot import QtBot

from deploy.demo.ports import free_ports
from deploy.demo.station import running, shipped_parts, station_toml
from station.defects import KINDS
from station.files.image import read_image
from station.journal.accounts import Accounts
from station.journal.commissioning import make_code
from station.journal.journal import Kind, entries
from station.journal.reviews import Opinion, State, reviews
from station.journal.users import Level
from station.panel.app import open_window
from station.panel.pages.history.page import HistoryPage
from station.panel.pages.live.page import LivePage
from station.panel.pages.replay.page import ReplayPage
from station.panel.pages.setup.page import SetupPage
from station.panel.pages.table import PageKey
from station.panel.window import HEADER_PX, NAV_PX, Window
from station.plc.map.alarms import Alarm
from station.plc.map.registers import VerdictCode
from station.plc.simulated.line import Answer, SimulatedLine
from station.settings import adjustments
from station.settings.keys import keys_folder
from synth.camera.feed import Feed
from tests.desk import PIN

LEFT = Qt.MouseButton.LeftButton


class Line:
    """Parts pass through the engine, in a thread of their own."""

    def __init__(self, feed: Feed, port: int) -> None:
        self._feed, self._port = feed, port
        self.answers: list[Answer] = []

    def passes(self, qtbot: QtBot, count: int) -> list[Answer]:
        """Until `count` parts are answered; the window lives meanwhile."""
        self.answers = []
        thread = threading.Thread(target=lambda: asyncio.run(self._drive(count)))
        thread.start()
        qtbot.waitUntil(lambda: not thread.is_alive(), timeout=60_000)
        thread.join()
        return self.answers

    async def _drive(self, count: int) -> None:
        line, parts = SimulatedLine.at("127.0.0.1", self._port, accept_simulated=True), shipped_parts()
        await line.connect()
        for number in range(count):
            self._feed.show(read_image(parts[number % len(parts)].path))
            self.answers.append(await line.inspect(f"CELL-{number}", 22.0))
        await line.close()


@pytest.fixture
def station(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[tuple[Path, Line]]:
    """A parameter: more lines of the settings file."""
    feed, port = Feed(tmp_path / "feed"), free_ports(1)[0]
    path = tmp_path / "station.toml"
    path.write_text(
        station_toml(tmp_path / "records", port, deadline_ms=20_000) + getattr(request, "param", "")
    )
    with (
        (tmp_path / "engine.log").open("w") as log,
        running(
            [sys.executable, "-m", "station", "engine", "-c", str(path)],
            {**os.environ, **feed.environment},
            log,
        ),
    ):
        yield path, Line(feed, port)


@pytest.fixture
def window(station: tuple[Path, Line], qtbot: QtBot) -> Iterator[Window]:
    shown = open_window(station[0])
    qtbot.addWidget(shown)
    shown.show()
    qtbot.waitUntil(lambda: shown.session.received.engine_there, timeout=60_000)
    yield shown
    shown.close()


def log_in(window: Window, qtbot: QtBot, name: str, pin: str) -> SetupPage:
    """On the page Setup, by keys."""
    window.go(PageKey.SETUP)
    setup = window.page
    assert isinstance(setup, SetupPage)
    setup.show_tab(setup.login)
    setup.login.name.setEditText(name)
    if setup.login.code.isVisibleTo(setup.login):  # nobody has this name yet
        setup.login.code.setText(make_code(keys_folder(window.session.received._path)))
    setup.login.pin.clear()
    qtbot.keyClicks(setup.login.pin, pin)
    qtbot.mouseClick(setup.login.log_in, LEFT)
    qtbot.waitUntil(setup.login.log_in.isEnabled, timeout=10_000)  # the engine has answered
    return setup


def test_a_day_at_the_station(station: tuple[Path, Line], window: Window, qtbot: QtBot) -> None:
    path, line = station
    session, folder = window.session, window.session.received.folder
    answers = line.passes(qtbot, 4)
    nok = [a for a in answers if a.verdict is VerdictCode.NOK]
    ok = [a for a in answers if a.verdict is VerdictCode.OK]
    assert nok
    assert ok
    qtbot.waitUntil(lambda: len(session.received.parts) == 4, timeout=5000)

    # the first to log in becomes administrator, and makes the other users
    log_in(window, qtbot, "Ada", PIN)
    assert session.account.user is not None
    assert session.account.user.level is Level.ADMIN
    accounts = Accounts(folder, keys_folder(path))
    accounts.save_user("Quentin", level=Level.QUALITY, pin="234567", by="Ada")

    # find a NOK, look at it, review it, the second person too
    window.go(PageKey.HISTORY)
    history = window.page
    assert isinstance(history, HistoryPage)
    history.fields.since.setCurrentText("last hour")
    history.fields.verdict.setCurrentText("NOK")
    assert history.film.count() == len(nok)
    history.film.setCurrentRow(0)
    number = history.film.chosen()
    assert number == nok[-1].inspection_id
    assert history.record.record is not None
    assert history.record.findings.rowCount() >= 1
    assert history.record.weld.drawn is not None
    qtbot.mouseClick(history.reviewing.opinions[Opinion.FALSE_CALL], LEFT)
    qtbot.waitUntil(lambda: number in reviews(folder), timeout=5000)
    assert reviews(folder)[number].state is State.ONE
    assert not history.reviewing.opinions[Opinion.MISSED].isEnabled(), "a NOK part cannot have been missed"

    # change a threshold: what if first, then a reason
    setup = log_in(window, qtbot, "Quentin", "234567")
    give_second = history.reviewing.opinions[Opinion.FALSE_CALL]
    give_second.click()
    qtbot.waitUntil(lambda: reviews(folder)[number].agreed is Opinion.FALSE_CALL, timeout=5000)
    setup.show_tab(setup.recipe)
    recipe = setup.recipe
    recipe.fields["limits.hole.min_mm"].edit.setText("99")
    assert recipe.fields["limits.hole.min_mm"].problem == "allowed: 0 … 5"
    assert not recipe.ask.isEnabled()
    recipe.fields["limits.hole.min_mm"].edit.setText("1.5")
    assert not recipe.save.isEnabled(), "nobody asked what if"
    qtbot.mouseClick(recipe.ask, LEFT)
    qtbot.waitUntil(lambda: bool(recipe.message.text()), timeout=10_000)
    released = [int(row[0]) for row in recipe.released.texts()]
    assert recipe.rejected.rowCount() == 0
    assert released
    assert set(released) < {a.inspection_id for a in nok}, "holes are tolerated, missing welds are not"
    assert not recipe.save.isEnabled(), "a reason is needed"
    qtbot.keyClicks(recipe.reason, "trial of the minimum length")
    crc = session.received.status.config_crc if session.received.status else 0
    qtbot.mouseClick(recipe.save, LEFT)
    qtbot.waitUntil(
        lambda: session.received.status is not None and session.received.status.config_crc != crc,
        timeout=20_000,
    )
    qtbot.waitUntil(lambda: recipe.message.text() == "Saved and in use.", timeout=5000)
    assert adjustments.read(path) == {"recipes": {"1": {"model": {"limits": {"hole": {"min_mm": 1.5}}}}}}
    (change,) = entries(folder, (Kind.SETTING,))
    assert (change.who, change.subject, change.after) == (
        "Quentin",
        "recipes.1.model.limits.hole.min_mm",
        "1.5",
    )
    assert change.reason == "trial of the minimum length"
    again = line.passes(qtbot, 4)
    assert sum(a.verdict is VerdictCode.OK for a in again) == len(ok) + len(released), (
        "as the what-if predicted"
    )

    # log out
    setup.show_tab(setup.login)
    qtbot.mouseClick(setup.login.log_out, LEFT)
    assert session.account.user is None
    assert not recipe.save.isEnabled()
    qtbot.waitUntil(
        lambda: next(e.kind for e in entries(folder, (Kind.LOGIN, Kind.LOGOUT))) is Kind.LOGOUT, timeout=5000
    )


def test_limits_that_the_station_refuses_are_undone(
    station: tuple[Path, Line], window: Window, qtbot: QtBot
) -> None:
    """Its stored frame would be too blurred for them: the station would not come up again."""
    path, line = station
    line.passes(qtbot, 1)
    setup = log_in(window, qtbot, "Ada", PIN)
    setup.show_tab(setup.recipe)
    recipe = setup.recipe
    recipe.fields["min_sharpness"].edit.setText("5")
    recipe.reason.setText("trial of the sharpness limit")
    qtbot.mouseClick(recipe.ask, LEFT)
    qtbot.waitUntil(recipe.save.isEnabled, timeout=10_000)
    qtbot.mouseClick(recipe.save, LEFT)
    qtbot.waitUntil(lambda: "Nothing was changed" in recipe.problem.text(), timeout=20_000)
    assert adjustments.read(path) == {}
    found = entries(window.session.received.folder, (Kind.SETTING,))
    assert [(e.before, e.after) for e in found] == [("5", "0.01"), ("0.01", "5")]
    assert found[0].reason.startswith("refused: ")
    assert found[1].reason == "trial of the sharpness limit"
    assert recipe.fields["min_sharpness"].value == 0.01
    status = window.session.received.status
    assert status is not None
    assert Alarm.SETTINGS_REFUSED not in status.alarms, "the settings file is as good as before"


def test_a_record_whose_image_was_deleted_is_shown_as_such(
    station: tuple[Path, Line], window: Window, qtbot: QtBot
) -> None:
    _, line = station
    line.passes(qtbot, 1)
    next(window.session.received.folder.glob("????-??-??/*.png")).unlink()
    window.go(PageKey.HISTORY)
    history = window.page
    assert isinstance(history, HistoryPage)
    history.search()
    history.film.setCurrentRow(0)
    history.show_chosen()
    assert history.record.weld.drawn is None
    assert "was deleted" in history.record.weld.note
    assert "cannot be read" in history.record.problem.text()
    assert history.record.strip.scores


def test_five_wrong_pins_lock_a_user_and_rights_depend_on_the_level(window: Window, qtbot: QtBot) -> None:
    folder = window.session.received.folder
    accounts = Accounts(folder, keys_folder(window.session.received._path))
    accounts.save_user("Ada", level=Level.ADMIN, pin=PIN, by="Ada")
    accounts.save_user("Sam", level=Level.SETTER, pin="3456", by="Ada")
    for _ in range(5):
        setup = log_in(window, qtbot, "Sam", "0000")
        assert setup.login.problem.text() == "unknown name or wrong PIN"
    setup = log_in(window, qtbot, "Sam", "3456")
    assert "Locked for one minute" in setup.login.problem.text()
    assert window.session.account.user is None
    assert not setup.people.save.isEnabled()
    assert not setup.camera.live.isEnabled()
    log_in(window, qtbot, "Ada", PIN)
    assert setup.people.save.isEnabled()


def test_service_mode_from_the_line_page_is_reported_to_the_plc_and_ends_with_the_login(
    window: Window, qtbot: QtBot
) -> None:
    session = window.session
    log_in(window, qtbot, "Ada", PIN)
    window.go(PageKey.LINE)
    page = window.page
    qtbot.mouseClick(page.service, LEFT)  # type: ignore[attr-defined]
    qtbot.waitUntil(
        lambda: session.received.status is not None and session.received.status.service == "Ada",
        timeout=10_000,
    )
    session.account.log_out()
    qtbot.waitUntil(
        lambda: session.received.status is not None and not session.received.status.service, timeout=10_000
    )


@pytest.mark.parametrize("station", ["[panel]\nlogout_min = 0.1\n"], indirect=True)
def test_nobody_stays_logged_in_for_ever(window: Window, qtbot: QtBot) -> None:
    session = window.session
    log_in(window, qtbot, "Ada", PIN)
    assert session.account.user is not None
    qtbot.waitUntil(lambda: session.account.user is None, timeout=15_000)
    folder = session.received.folder
    qtbot.waitUntil(lambda: [e.reason for e in entries(folder, (Kind.LOGOUT,))] == ["idle"], timeout=5000)


def test_the_defect_map_of_the_last_nok_is_laid_over_its_strip(
    station: tuple[Path, Line], window: Window, qtbot: QtBot
) -> None:
    _, line = station
    line.passes(qtbot, 4)
    live = window.page
    assert isinstance(live, LivePage)
    qtbot.waitUntil(lambda: len(window.session.received.parts) == 4, timeout=10_000)
    qtbot.waitUntil(live.show_map.isEnabled, timeout=10_000)
    qtbot.mouseClick(live.show_map, LEFT)
    qtbot.waitUntil(lambda: live.nok_strip.overlay is not None, timeout=20_000)
    qtbot.mouseClick(live.nok_strip, LEFT)
    history = window.page
    assert isinstance(history, HistoryPage)
    assert window.session.received.last_nok is not None
    assert history.film.chosen() == window.session.received.last_nok.part.record.inspection_id
    overlay = live.nok_strip.overlay
    assert overlay is not None
    seen = [
        overlay.pixelColor(x, y).alpha()
        for x in range(0, overlay.width(), 8)
        for y in range(0, overlay.height(), 4)
    ]
    assert max(seen) > 100
    assert sum(a > 100 for a in seen) < len(seen) / 2


def test_recorded_parts_are_judged_again_in_the_window(
    station: tuple[Path, Line], window: Window, qtbot: QtBot, tmp_path: Path
) -> None:
    _, line = station
    answers = line.passes(qtbot, 4)
    log_in(window, qtbot, "Ada", PIN)
    window.go(PageKey.REPLAY)
    page = window.page
    assert isinstance(page, ReplayPage)
    qtbot.mouseClick(page.judge, LEFT)
    qtbot.waitUntil(lambda: page.done is not None, timeout=20_000)
    assert page.table.rowCount() == 4
    assert page.message.text().endswith("4 compared with the line, 0 verdicts differ")
    nok = [a for a in answers if a.verdict is VerdictCode.NOK]
    assert sum(row[2] == "NOK" for row in page.table.texts()) == len(nok)
    page.table.selectRow(0)
    qtbot.waitUntil(lambda: page.weld.drawn is not None, timeout=10_000)
    assert page.weld.drawn is not None
    assert page.weld.drawn.ring is not None
    page.only_flips.setChecked(True)
    assert page.table.rowCount() == 0
    page.write_report(tmp_path / "out")
    qtbot.waitUntil((tmp_path / "out" / "replay.json").exists, timeout=10_000)
    assert "4 parts compared" in (tmp_path / "out" / "report.html").read_text()
    page.folder.setText(str(tmp_path / "nowhere"))
    page.what.setCurrentIndex(page.what.count() - 1)
    qtbot.waitUntil(lambda: not page.work.busy, timeout=5000)
    page.start()
    qtbot.waitUntil(lambda: "no such file or folder" in page.problem.text(), timeout=10_000)


def test_the_history_is_searched_by_time_and_review_and_written_as_a_table(
    station: tuple[Path, Line], window: Window, qtbot: QtBot, tmp_path: Path
) -> None:
    _, line = station
    answers = line.passes(qtbot, 4)
    nok = [a.inspection_id for a in answers if a.verdict is VerdictCode.NOK]
    log_in(window, qtbot, "Ada", PIN)
    window.go(PageKey.HISTORY)
    page = window.page
    assert isinstance(page, HistoryPage)
    fields = page.fields
    fields.state.setCurrentText("to be confirmed")
    assert sorted(page.film.rows) == nok
    page.film.setCurrentRow(0)
    page.give_review(Opinion.RIGHT)
    qtbot.waitUntil(lambda: not page.waiting, timeout=5000)
    fields.state.setCurrentText("reviewed once")
    assert list(page.film.rows) == [nok[-1]]
    qtbot.waitUntil(page.show_map.isEnabled, timeout=5000)
    qtbot.mouseClick(page.show_map, LEFT)
    qtbot.waitUntil(lambda: page.record.strip.overlay is not None, timeout=20_000)
    fields.state.setCurrentIndex(0)
    ok = next(a.inspection_id for a in answers if a.verdict is VerdictCode.OK)
    page.film.setCurrentRow(list(page.film.rows).index(ok))
    missed = page.reviewing.opinions[Opinion.MISSED]
    assert not missed.isEnabled(), "no segment is marked yet"
    for _ in range(2):
        qtbot.mouseClick(page.record.strip, LEFT, pos=QPoint(page.record.strip.width() // 2, 20))
    qtbot.mouseClick(missed, LEFT)
    qtbot.waitUntil(lambda: not page.waiting, timeout=5000)
    assert reviews(window.session.received.folder)[ok].marks == {"Ada": {11: KINDS[1].reason}}, (
        "each click marks the next kind"
    )
    assert not missed.isEnabled(), "the marks are hers, not those of the next"
    fields.since.setCurrentText("from … to …")
    assert fields.begin.isVisible()
    assert len(page.film.rows) == 4
    page.exports.write_table(tmp_path / "parts.csv")
    qtbot.waitUntil((tmp_path / "parts.csv").exists, timeout=10_000)
    qtbot.waitUntil(lambda: not page.work.busy, timeout=5000)
    assert len((tmp_path / "parts.csv").read_text().splitlines()) == 5
    fields.end.setDateTime(fields.begin.dateTime().addSecs(60))
    page.search()
    assert not page.film.rows
    assert page.record.record is None, "the part before must not stay in sight"
    window.resize(1280, 800)
    for language in ("en", "de"):  # with a record in it
        window.speak(language)
        opened = window.page
        assert isinstance(opened, HistoryPage)
        opened.film.setCurrentRow(0)
        qtbot.wait(100)
        assert opened.record.record is not None
        assert opened.minimumSizeHint().width() <= 1280 - NAV_PX
        assert opened.minimumSizeHint().height() <= 800 - HEADER_PX

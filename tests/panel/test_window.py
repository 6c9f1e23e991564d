"""The window over a real channel, offscreen."""

import time

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QPushButton
from pytestqt.qtbot import QtBot

from station.channel.preview import make_preview
from station.channel.zeromq import Publisher, Subscriber
from station.domain import Image, Ring
from station.engine.orders import TestImage
from station.errors import LineError
from station.journal.users import Level
from station.panel.look import theme
from station.panel.pages.history.page import HistoryPage
from station.panel.pages.live.page import LivePage
from station.panel.pages.setup.page import SetupPage
from station.panel.pages.table import PAGES, PageKey
from station.panel.widgets.keys import Keys
from station.panel.window import HEADER_PX, NAV_PX, Window
from station.plc.map.alarms import Alarm
from station.plc.map.registers import Offline
from station.plc.port import Counts
from station.settings.model import ChannelSettings
from tests.desk import Desk
from tests.panel.made import log_in, part, status
from tests.parts import label_with, nok_inspection, ok_inspection

TABS_PX = 80
"""Of the page Setup, with its margins."""


def live(window: Window) -> LivePage:
    window.go(PageKey.LIVE)
    page = window.page
    assert isinstance(page, LivePage)
    return page


def test_events_reach_the_window(
    window: Window, publisher: Publisher, qtbot: QtBot, frames: dict[str, Image]
) -> None:
    item = label_with("hole")
    ring = Ring(item["center"][0], item["center"][1], item["radius"], 1.0)
    event, preview = part(nok_inspection(), 12), make_preview(12, frames[item["frame"]], ring, um_per_px=13.0)
    publisher_said = [False]

    def received() -> None:
        publisher.send(status(alarms=(int(Alarm.PICTURES_DRIFT),)))
        if not publisher_said[0]:
            publisher.send(event)
        publisher.show(preview)
        page = live(window)
        publisher_said[0] = page.facts.values["part"].text() == "12"
        assert publisher_said[0]
        assert page.facts.values["parts"].text() == "4"
        assert page.lamp.lamp.word == "NOK"
        assert page.weld.drawn is not None
        assert window.session.received.last_nok is not None

    qtbot.waitUntil(received, timeout=5000)
    assert window.badge.text() == "SIMULATED CAMERA"
    assert window.buttons[PageKey.ALARMS].text() == "Alarms (1)"
    assert live(window).clock.counts[3] >= 1
    picture = window.grab().toImage()
    colors = {
        picture.pixelColor(x, y).name()
        for x in range(0, picture.width(), 4)
        for y in range(0, picture.height(), 4)
    }
    assert theme.DARK.bad in colors, "the NOK red is nowhere on the window"


def test_a_part_without_its_image_is_never_shown_on_the_image_of_another(
    window: Window, frames: dict[str, Image], qtbot: QtBot
) -> None:
    session = window.session
    item = label_with("OK")
    session.bridge.parts.emit([part(ok_inspection(), 1)])
    session.bridge.preview.emit(make_preview(1, frames[item["frame"]], None, um_per_px=13.0))
    assert live(window).weld.note == ""
    session.bridge.parts.emit([part(ok_inspection(), 2)])
    assert "no image of this part" in live(window).weld.note


def test_the_button_asks_the_engine_for_a_test_image(
    window: Window, publisher: Publisher, desk: Desk, qtbot: QtBot
) -> None:
    assert not live(window).test.isEnabled(), "nobody is logged in, nothing was received from an engine yet"
    log_in(window.session, desk, qtbot, "Bob", Level.OPERATOR)
    assert not live(window).test.isEnabled(), "nothing was received from an engine yet"

    def received() -> None:
        publisher.send(status())
        assert live(window).test.isEnabled()

    qtbot.waitUntil(received, timeout=5000)
    assert desk.given == []
    qtbot.mouseClick(live(window).test, Qt.MouseButton.LeftButton)
    qtbot.waitUntil(lambda: desk.given == [TestImage()], timeout=5000)


def test_without_an_engine_it_says_so_and_shows_no_verdict(window: Window) -> None:
    session = window.session
    session.bridge.status.emit(status())
    session.bridge.parts.emit([part(ok_inspection())])
    assert live(window).lamp.lamp.word == "OK"
    session.bridge.status.emit(status(at_s=time.monotonic() - 10))
    live(window).age()
    assert live(window).lamp.lamp.word == "OFFLINE"
    assert "No connection to the engine" in window.alarm.text()


def test_a_restarted_engine_needs_no_new_panel(
    window: Window, settings: ChannelSettings, qtbot: QtBot
) -> None:
    for _ in range(2):
        end = Publisher(settings)

        def received(end: Publisher = end) -> None:
            end.send(status())
            assert live(window).lamp.lamp.word == "NO VERDICT"

        qtbot.waitUntil(received, timeout=5000)
        end.close()
        window.session.bridge.status.emit(status(at_s=time.monotonic() - 10))
        assert live(window).lamp.lamp.word == "OFFLINE"


def test_language_and_theme_change_at_once_and_nothing_is_forgotten(window: Window, qtbot: QtBot) -> None:
    window.session.bridge.status.emit(status(counts=Counts(7, 2, 1)))
    window.session.bridge.parts.emit([part(nok_inspection(), 5)])
    window.go(PageKey.STATISTICS)
    window.speak("de")
    titles = [button.text() for button in window.buttons.values()]
    assert titles == ["Live", "Verlauf", "Statistik", "Linie", "Alarme", "Einrichten", "Wiedergabe"]
    assert window.shown is PageKey.STATISTICS
    window.dress("light")
    assert live(window).facts.values["parts"].text() == "10"
    assert live(window).facts.values["part"].text() == "5"
    assert theme.colors() is theme.LIGHT
    window.session.bridge.status.emit(status())
    assert live(window).lamp.lamp.word == "NOK"


@pytest.mark.parametrize("size", [(1280, 800), (1920, 1080)])
def test_every_page_fits_the_screen_in_both_languages(
    window: Window, size: tuple[int, int], qtbot: QtBot
) -> None:
    window.resize(*size)
    for language in ("en", "de"):
        window.speak(language)
        for info in PAGES:
            window.go(info.key)
            page = window.page
            hint = page.minimumSizeHint()
            assert hint.width() <= size[0] - NAV_PX, page
            assert hint.height() <= size[1] - HEADER_PX, page
        window.go(PageKey.SETUP)
        setup = window.page
        assert isinstance(setup, SetupPage)
        for tab in (setup.login, setup.camera, setup.recipe, setup.masters, setup.people, setup.journal):
            assert tab.minimumSizeHint().width() <= size[0] - NAV_PX - 20, tab
            assert tab.minimumSizeHint().height() <= size[1] - HEADER_PX - TABS_PX, tab


def test_keys_lead_to_pages(window: Window, qtbot: QtBot) -> None:
    window.activateWindow()
    for number, info in enumerate(PAGES):
        qtbot.keyClick(window, Qt.Key(Qt.Key.Key_F1.value + number))
        assert window.shown is info.key
        assert window.buttons[info.key].isChecked()


def test_each_page_has_one_line_in_the_table_and_its_button_leads_to_it(window: Window, qtbot: QtBot) -> None:
    assert [info.key for info in PAGES] == list(PageKey)
    for key, button in window.buttons.items():
        qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
        assert window.shown is key
    qtbot.mouseClick(window.user, Qt.MouseButton.LeftButton)
    assert window.shown is PageKey.SETUP
    window.alarm.click()
    assert window.shown is PageKey.ALARMS
    window.session.part_chosen.emit(1)
    assert window.shown is PageKey.HISTORY


def test_keys_on_the_screen_write_where_the_cursor_stands(window: Window, qtbot: QtBot) -> None:
    window.speak("de")
    window.go(PageKey.HISTORY)
    page = window.page
    assert isinstance(page, HistoryPage)
    window.activateWindow()
    page.fields.serial.setFocus()
    window.keyboard.click()
    (keys,) = window.findChildren(Keys)
    for text in ("⇧", "z", "ü", "␣", "7", "⌫"):
        (key,) = [button for button in keys.findChildren(QPushButton) if button.text().lower() == text]
        qtbot.mouseClick(key, Qt.MouseButton.LeftButton)
    assert page.fields.serial.text() == "Zü "
    window.keyboard.click()
    qtbot.waitUntil(lambda: not window.findChildren(Keys), timeout=1000)


def test_a_lost_plc_is_shown(window: Window) -> None:
    window.session.bridge.status.emit(status(Offline.PLC_SILENT))
    assert live(window).lamp.lamp.word == "PLC LOST"


def test_a_hanging_panel_costs_the_engine_nothing(settings: ChannelSettings, publisher: Publisher) -> None:
    subscriber = Subscriber(settings)
    for _ in range(5000):
        publisher.send(status())
    subscriber.close()


def test_closing_leaves_no_window_behind(window: Window) -> None:
    window.close()
    assert not [w for w in QApplication.topLevelWidgets() if w.isVisible()]


def test_pages_that_are_built_again_leave_none_behind(window: Window, qtbot: QtBot) -> None:
    def widgets() -> int:
        qtbot.wait(50)
        return len(QApplication.allWidgets())

    def open_all_pages() -> None:
        for language in ("de", "en"):
            window.speak(language)
            for info in PAGES:
                window.go(info.key)

    open_all_pages()
    before = widgets()
    start = time.monotonic()
    for _ in range(3):
        open_all_pages()
    assert widgets() <= before, f"after {time.monotonic() - start:.1f} s"


def test_a_channel_in_use_is_reported(settings: ChannelSettings, publisher: Publisher) -> None:
    with pytest.raises(LineError, match=r"another engine uses .*channel\.folder"):
        Publisher(settings)

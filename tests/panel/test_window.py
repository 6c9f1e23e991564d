"""The window over a real channel, offscreen."""

from collections.abc import Iterator

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from deploy.demo import free_ports
from station.channel import Inbox, Outbox, Publisher, Subscriber
from station.domain import Image, Origin, Ring
from station.errors import LineError
from station.events import Counts, PartEvent, StatusEvent
from station.panel.bridge import Bridge
from station.panel.window import Window
from station.plc.registers import Offline
from station.preview import make_preview
from station.settings import ChannelSettings
from tests.parts import label_with, nok_inspection, record


@pytest.fixture
def settings() -> ChannelSettings:
    events_port, preview_port, requests_port = free_ports(3)
    return ChannelSettings(events_port=events_port, preview_port=preview_port, requests_port=requests_port)


@pytest.fixture
def publisher(settings: ChannelSettings) -> Iterator[Publisher]:
    end = Publisher(settings)
    yield end
    end.close()


@pytest.fixture
def window(settings: ChannelSettings, qtbot: QtBot) -> Iterator[Window]:
    shown = Window(Bridge(Subscriber(settings), Outbox(settings)))
    qtbot.addWidget(shown)
    shown.show()
    yield shown
    shown.close()


def status(origin: Origin = Origin.SIMULATED) -> StatusEvent:
    return StatusEvent(True, "", True, True, Offline.NONE, origin, Counts(3, 1, 0))


def test_events_reach_the_window(window: Window, publisher: Publisher, qtbot: QtBot, frames: dict[str, Image]) -> None:
    item = label_with("hole")
    judged = nok_inspection()
    ring = Ring(item["center"][0], item["center"][1], item["radius"], 1.0)
    event = PartEvent(record(judged, 12), tuple(i == 3 for i in range(21)), True, None, True, 90.0, 1.0)
    preview = make_preview(12, frames[item["frame"]], ring)

    def told() -> None:
        publisher.send(status())
        publisher.send(event)
        publisher.show(preview)
        assert window._facts["part"].text() == "no. 12"
        assert window._facts["parts"].text() == "4"
        assert window._facts["picture"].text() == "UNLIKE TRAINING"
        assert window._lamp._lamp.word == "NOK"
        assert window._live._preview is not None

    qtbot.waitUntil(told, timeout=5000)
    assert window._badge.text() == "SIMULATED CAMERA"
    picture = window.grab().toImage()
    colors = {picture.pixelColor(x, y).name() for x in range(0, picture.width(), 4) for y in range(0, picture.height(), 4)}
    assert "#e0483e" in colors, "the NOK red is nowhere on the window"


def test_the_button_asks_the_engine_for_a_test_picture(
    window: Window, publisher: Publisher, settings: ChannelSettings, qtbot: QtBot
) -> None:
    assert not window._test.isEnabled(), "no engine was heard yet"
    inbox = Inbox(settings)
    try:

        def heard() -> None:
            publisher.send(status())
            assert window._test.isEnabled()

        qtbot.waitUntil(heard, timeout=5000)
        assert not inbox.asked()

        def asked() -> None:
            qtbot.mouseClick(window._test, Qt.MouseButton.LeftButton)
            assert inbox.asked()

        qtbot.waitUntil(asked, timeout=5000)
    finally:
        inbox.close()


def test_without_an_engine_it_says_so(window: Window) -> None:
    window._age()
    assert window._lamp._lamp.word == "OFFLINE"


def test_a_restarted_engine_needs_no_new_panel(window: Window, settings: ChannelSettings, qtbot: QtBot) -> None:
    for _ in range(2):
        end = Publisher(settings)

        def told(end: Publisher = end) -> None:
            end.send(status())
            assert window._lamp._lamp.word == "NO VERDICT"

        qtbot.waitUntil(told, timeout=5000)
        end.close()
        window._status_s -= 10
        window._age()
        assert window._lamp._lamp.word == "OFFLINE"


def test_a_hanging_panel_costs_the_engine_nothing(settings: ChannelSettings, publisher: Publisher) -> None:
    subscriber = Subscriber(settings)
    for _ in range(5000):
        publisher.send(status())
    subscriber.close()


def test_closing_leaves_no_window_behind(window: Window) -> None:
    window.close()
    assert not [w for w in QApplication.topLevelWidgets() if w.isVisible()]


def test_a_taken_channel_port_is_said(settings: ChannelSettings, publisher: Publisher) -> None:
    with pytest.raises(LineError, match=r"channel\.events_port"):
        Publisher(settings)

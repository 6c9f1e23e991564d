"""Each test gets the language and the theme that the window begins with, and leaves no window behind."""

import gc
from collections.abc import Iterator
from pathlib import Path

import pytest
import shiboken6
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from deploy.demo.ports import free_ports
from deploy.demo.station import station_toml
from station.archive.schema import open_index
from station.channel.zeromq import Publisher
from station.panel.app import open_window
from station.panel.look import theme, words
from station.panel.window import Window
from station.settings.file import load
from station.settings.model import ChannelSettings
from tests.desk import Desk


@pytest.fixture(autouse=True)
def _as_it_begins() -> Iterator[None]:
    yield
    for widget in QApplication.topLevelWidgets():
        if isinstance(widget, Window) and shiboken6.isValid(widget):
            widget.close()
            shiboken6.delete(widget)
    gc.collect()
    if QApplication.instance() is not None:
        words.use("en")
        theme.use("dark")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    made = tmp_path / "station.toml"
    made.write_text(station_toml(tmp_path / "records", free_ports(1)[0]))
    (tmp_path / "records").mkdir()
    open_index(tmp_path / "records").close()
    return made


@pytest.fixture
def settings(path: Path) -> ChannelSettings:
    return load(path).channel


@pytest.fixture
def desk(path: Path) -> Iterator[Desk]:
    """What answers the window, as an engine without a line."""
    end = Desk(path)
    yield end
    end.close()


@pytest.fixture
def publisher(settings: ChannelSettings) -> Iterator[Publisher]:
    end = Publisher(settings)
    yield end
    end.close()


@pytest.fixture
def window(path: Path, qtbot: QtBot) -> Iterator[Window]:
    shown = open_window(path)
    qtbot.addWidget(shown)
    shown.show()
    yield shown
    shown.close()

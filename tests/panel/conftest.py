"""Each test gets the language and the theme that the window begins with, and leaves no window behind."""

import gc
from collections.abc import Iterator

import pytest
import shiboken6
from PySide6.QtWidgets import QApplication

from station.panel import theme, words
from station.panel.window import Window


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

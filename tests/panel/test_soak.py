"""Many events leave nothing behind."""

import sys
from pathlib import Path

from PySide6.QtWidgets import QLabel
from pytestqt.qtbot import QtBot

from deploy.chaos.soak_panel import soak


def test_many_parts_leave_no_widget_thread_or_connection_behind(tmp_path: Path, qtbot: QtBot) -> None:
    levels = soak(tmp_path, 800)
    later = levels[5:]
    assert len({(level.widgets, level.threads, level.files) for level in later}) == 1, levels
    assert later[-1].memory_mb - later[0].memory_mb < 15, levels


def test_calls_into_qt_keep_their_references(qtbot: QtBot) -> None:
    """PySide6 6.12.0 on Python 3.11 drops a reference to None with each call: a window crashes in minutes."""
    label = QLabel()
    qtbot.addWidget(label)
    before = sys.getrefcount(None)
    for number in range(1000):
        label.setText(str(number))
    assert sys.getrefcount(None) > before - 100

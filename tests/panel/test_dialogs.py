"""Where files go: with their ending, never over another one unasked, never for a user who was logged out."""

from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication, QDialogButtonBox, QFileDialog, QLineEdit, QMessageBox
from pytestqt.qtbot import QtBot

from station.journal.users import Level
from station.panel.widgets.dialogs import ask_file
from station.panel.window import Window
from tests.desk import Desk
from tests.panel.made import log_in


def answered(
    window: Window, typed: Path, over: bool | None, meanwhile: Callable[[], None] = lambda: None
) -> Path | None:
    """Type a name and return the result; `over` answers whether to replace a file, None: nothing is asked."""
    asked: list[bool] = []

    def answer() -> None:
        box = QApplication.activeModalWidget()
        if isinstance(box, QMessageBox):
            asked.append(bool(over))
            box.button(QMessageBox.StandardButton.Yes if over else QMessageBox.StandardButton.No).click()

    def write() -> None:
        dialog = QApplication.activeModalWidget()
        assert isinstance(dialog, QFileDialog)
        meanwhile()
        dialog.findChildren(QLineEdit)[0].setText(str(typed))
        QTimer.singleShot(200, answer)
        dialog.findChildren(QDialogButtonBox)[0].button(QDialogButtonBox.StandardButton.Save).click()
        QTimer.singleShot(400, dialog.reject)  # if it is still there

    QTimer.singleShot(200, write)
    found = ask_file(window, window.session, "Table", "parts.csv")
    assert bool(asked) == (over is not None)
    return found


@pytest.mark.parametrize("name", ["lot", "lot.csv"])
def test_a_file_gets_its_suffix_and_replaces_another_only_after_a_yes(
    window: Window, desk: Desk, qtbot: QtBot, tmp_path: Path, name: str
) -> None:
    log_in(window.session, desk, qtbot, "Bob", Level.OPERATOR)
    target = tmp_path / "lot.csv"
    assert answered(window, tmp_path / name, None) == target
    target.write_text("before")
    assert answered(window, tmp_path / name, False) is None
    assert answered(window, tmp_path / name, True) == target


def test_the_answer_of_a_dialog_is_dropped_if_its_user_was_logged_out(
    window: Window, desk: Desk, qtbot: QtBot, tmp_path: Path
) -> None:
    log_in(window.session, desk, qtbot, "Bob", Level.OPERATOR)
    assert answered(window, tmp_path / "lot", None, window.session.account.log_out) is None

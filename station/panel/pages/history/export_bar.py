"""Buttons that write the found or the reviewed parts into files."""

from collections.abc import Callable, Sequence
from pathlib import Path

from PySide6.QtWidgets import QHBoxLayout, QPushButton, QWidget

from station.panel.look.words import translate
from station.panel.pages.history.exports import Written, write_reviewed, write_table
from station.panel.session.session import Session
from station.panel.widgets.card import label
from station.panel.widgets.dialogs import ask_file, ask_folder
from station.panel.widgets.work import WorkBar


class ExportBar(QWidget):
    """Asks where to write and lets a work bar do it; `result` is placed by the page."""

    def __init__(self, session: Session, work: WorkBar, numbers: Callable[[], Sequence[int]]) -> None:
        """`numbers` returns the numbers of the parts in the list."""
        super().__init__()
        self._session, self._work, self._numbers = session, work, numbers
        self.result = label("", "quiet", wrap=True)
        self.table = QPushButton(translate("history", "Table…"))
        self.table.setToolTip(translate("history", "Write the found parts as CSV"))
        self.table.clicked.connect(self._ask_table)
        self.export = QPushButton(translate("history", "Export reviewed…"))
        self.export.clicked.connect(self._ask_export)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        for button in (self.table, self.export):
            row.addWidget(button)

    def _ask_table(self) -> None:
        title = translate("history", "Write the found parts as CSV")
        path = ask_file(self, self._session, title, "parts.csv")
        if path is not None:
            self.write_table(path)

    def write_table(self, target: Path) -> None:
        """Write the parts in the list as a CSV file next to the window, one row each."""
        folder, numbers = self._session.received.folder, self._numbers()
        self._work.start(
            translate("history", "Writing the table"),
            lambda progress: write_table(folder, numbers, target, progress),
            self._on_written,
        )

    def _ask_export(self) -> None:
        title = translate("history", "Folder for the crops of reviewed parts")
        folder = ask_folder(self, self._session, title)
        if folder is not None:
            self.write_reviewed(folder / "reviewed")

    def write_reviewed(self, target: Path) -> None:
        """Write the crops of the parts that two people agree on next to the window."""
        folder = self._session.received.folder
        self._work.start(
            translate("history", "Exporting crops"),
            lambda progress: write_reviewed(folder, target, progress),
            self._on_written,
        )

    def _on_written(self, written: Written) -> None:
        text = translate("history", "{path}: {parts} parts written, {left_out} left out")
        self.result.setText(text.format(path=written.target, parts=written.parts, left_out=written.left_out))

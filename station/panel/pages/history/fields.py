"""The fields by which recorded parts are searched."""

from datetime import UTC, datetime
from pathlib import Path

from PySide6.QtCore import QDateTime, QSignalBlocker, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QDateTimeEdit,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from station.archive.reader import Row
from station.defects import Reason
from station.domain import SEGMENTS, Verdict
from station.journal.reviews import Review, State
from station.panel.look.words import data, translate
from station.panel.pages.history.search import TO_CONFIRM, Search
from station.panel.widgets.card import Choice, label

BETWEEN = -1
"""Stands for "from ... to ..." among the hours to choose from."""


class SearchFields(QWidget):
    """Fields for serial, time, verdict, reason, segment, score and state of the review."""

    asked = Signal()
    """Emitted when parts are to be searched."""

    def __init__(self) -> None:
        super().__init__()
        self.serial = QLineEdit()
        self.serial.setPlaceholderText(translate("history", "serial"))
        self.serial.setToolTip(translate("history", "A serial, or a prefix followed by *"))
        self.serial.setMinimumWidth(120)
        self.since, self.verdict, self.kind, self.segment, self.score, self.state = (
            Choice() for _ in range(6)
        )
        self._boxes = (self.since, self.verdict, self.kind, self.segment, self.score, self.state)
        self._fill()
        self.start = QPushButton(translate("history", "Search"))
        now = QDateTime.currentDateTime()
        self.begin, self.end = QDateTimeEdit(now.addDays(-1)), QDateTimeEdit(now.addSecs(60))
        self._between = QWidget()
        row = QHBoxLayout(self._between)
        row.setContentsMargins(0, 0, 0, 0)
        for text, edit in (
            (translate("history", "from"), self.begin),
            (translate("history", "to"), self.end),
        ):
            edit.setDisplayFormat("dd.MM.yyyy HH:mm")
            edit.setCalendarPopup(True)
            edit.editingFinished.connect(self.asked)
            row.addWidget(label(text, "quiet"))
            row.addWidget(edit)
        row.addStretch(1)
        self._between.hide()
        top = QHBoxLayout()
        top.addWidget(self.serial, 1)
        for box in self._boxes:
            box.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
            box.setMinimumContentsLength(8 if box is self.state else 6)
            box.currentIndexChanged.connect(self._on_chosen)
            top.addWidget(box)
        top.addWidget(self.start)
        rows = QVBoxLayout(self)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.addLayout(top)
        rows.addWidget(self._between)
        self.start.clicked.connect(self.asked)
        self.serial.returnPressed.connect(self.asked)

    def _fill(self) -> None:
        segment = translate("history", "segment")
        times = (
            (translate("history", "any time"), None),
            (translate("history", "last hour"), 1),
            (translate("history", "last 8 hours"), 8),
            (translate("history", "last day"), 24),
            (translate("history", "last week"), 168),
            (translate("history", "from … to …"), BETWEEN),
        )
        for text, hours in times:
            self.since.addItem(text, hours)
        choices: tuple[tuple[QComboBox, str, list[tuple[str, object]]], ...] = (
            (
                self.verdict,
                translate("history", "verdict"),
                [(data(verdict), str(verdict)) for verdict in Verdict],
            ),
            (self.kind, translate("history", "reason"), [(data(reason), str(reason)) for reason in Reason]),
            (
                self.segment,
                translate("history", "segment"),
                [(f"{segment} {number}", number) for number in range(1, SEGMENTS + 1)],
            ),
            (
                self.score,
                translate("history", "score"),
                [(f"≥ {score:g}", score) for score in (0.05, 0.2, 0.4, 0.6, 0.8, 0.95)],
            ),
            (
                self.state,
                translate("history", "review"),
                [
                    (translate("history", "to be confirmed"), TO_CONFIRM),
                    *((data(state), str(state)) for state in State),
                ],
            ),
        )
        for box, every, values in choices:
            box.addItem(every, None)
            for text, value in values:
                box.addItem(text, value)

    def clear(self) -> None:
        """Set all fields back, so that every part is found."""
        self.serial.clear()
        for box in self._boxes:
            with QSignalBlocker(box):
                box.setCurrentIndex(0)
        self._between.hide()

    def _on_chosen(self) -> None:
        self._between.setVisible(self.since.currentData() == BETWEEN)
        self.asked.emit()

    def asked_search(self) -> Search:
        """Return the search that the fields describe."""
        hours = self.since.currentData()
        between = hours == BETWEEN
        return Search(
            serial=self.serial.text(),
            hours=None if between else hours,
            since=_utc(self.begin) if between else None,
            until=_utc(self.end) if between else None,
            verdict=self.verdict.currentData(),
            reason=self.kind.currentData(),
            segment=self.segment.currentData(),
            score=self.score.currentData(),
            state=self.state.currentData(),
        )

    def search(self, folder: Path) -> tuple[list[Row], dict[int, Review]]:
        """Return the newest `FOUND` parts that match, and all reviews. Raises RecordError."""
        return self.asked_search().run(folder, datetime.now(UTC))


def _utc(edit: QDateTimeEdit) -> datetime:
    return datetime.fromtimestamp(edit.dateTime().toSecsSinceEpoch(), UTC)

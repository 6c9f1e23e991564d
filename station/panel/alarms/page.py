"""What is wrong: code, cause, what to do, when, acknowledged by whom."""

from datetime import datetime

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout

from station.archive.journal import Entry, Kind, append, entries
from station.errors import RecordError
from station.panel.card import Table, label
from station.panel.page import Page
from station.panel.session import Session
from station.panel.words import data, translate
from station.plc.alarms import TEXTS

SHOWN = 200
REFRESH_MS = 2000


class AlarmsPage(Page):
    """Follows the journal."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._rows: list[Entry] = []
        heads = ("", "code", "cause", "what to do", "since", "until", "acknowledged by")
        titles = {
            "": "",
            "code": translate("alarms", "code"),
            "cause": translate("alarms", "cause"),
            "what to do": translate("alarms", "what to do"),
            "since": translate("alarms", "since"),
            "until": translate("alarms", "until"),
            "acknowledged by": translate("alarms", "acknowledged by"),
        }
        self.table = Table([titles[head] for head in heads], stretch=3)
        self.acknowledge = QPushButton(translate("alarms", "Acknowledge"))
        self.acknowledge.clicked.connect(self._acknowledge)
        self._problem = label("", "problem")
        row = QHBoxLayout()
        row.addWidget(label(translate("alarms", "Choose an alarm to acknowledge it; who is logged in is noted."), "quiet"))
        row.addWidget(self._problem)
        row.addStretch(1)
        row.addWidget(self.acknowledge)
        column = QVBoxLayout(self)
        column.addWidget(self.table, 1)
        column.addLayout(row)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._when_seen)
        self._timer.start(REFRESH_MS)
        self.refresh()

    def _when_seen(self) -> None:
        if self.isVisible():
            self.refresh()

    def refresh(self) -> None:
        """Read the journal again."""
        try:
            told = entries(self._session.folder, (Kind.ALARM, Kind.ALARM_OVER, Kind.ALARM_SEEN), limit=3 * SHOWN)
        except RecordError as error:
            self._problem.setText(str(error))
            return
        over: dict[str, str] = {}
        seen = {e.subject: e.who for e in told if e.kind is Kind.ALARM_SEEN}
        rows, self._rows = [], []
        for entry in told:  # the newest first
            if entry.kind is Kind.ALARM_OVER:
                over[entry.subject] = entry.at
            elif entry.kind is Kind.ALARM:
                code = int(entry.subject.removeprefix("16#"), 16)
                lasts = code >= 0x3000
                until = over.pop(entry.subject, "") if lasts else entry.at
                text = TEXTS.get(code)
                cause = data(text.cause) if text else entry.subject
                cause += f" ({entry.after})" if entry.after else ""
                rows.append(
                    (
                        "" if until else "●",
                        entry.subject,
                        cause,
                        data(text.action) if text else "",
                        _local(entry.at),
                        (_local(until) if lasts else "") if until else translate("alarms", "lasts"),
                        seen.get(str(entry.number), ""),
                    )
                )
                self._rows.append(entry)
        self.table.fill(rows[:SHOWN])
        self._rows = self._rows[:SHOWN]

    def _acknowledge(self) -> None:
        row, user = self.table.currentRow(), self._session.user
        if user is None:
            self._problem.setText(translate("alarms", "log in first (page Setup)"))
        elif not 0 <= row < len(self._rows):
            self._problem.setText(translate("alarms", "choose an alarm first"))
        else:
            try:
                append(self._session.folder, Kind.ALARM_SEEN, user.name, str(self._rows[row].number))
                self._problem.setText("")
            except RecordError as error:
                self._problem.setText(str(error))
            self.refresh()

    def close_page(self) -> None:
        """Stop following."""
        self._timer.stop()


def _local(utc: str) -> str:
    return f"{datetime.fromisoformat(utc).astimezone():%d.%m. %H:%M:%S}"

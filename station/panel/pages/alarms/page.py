"""The page Alarms: each alarm with code, cause, what to do, when it was active, and who acknowledged it."""

from datetime import datetime

from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout

from station.channel.requests import Acknowledge, Answer
from station.errors import RecordError
from station.journal.journal import Kind, entries
from station.panel.look.words import data, translate
from station.panel.pages.page import FollowingPage
from station.panel.session.session import Session
from station.panel.widgets.card import Table, label, titled
from station.plc.map.alarms import TEXTS

SHOWN = 200
"""Maximum number of alarms that are shown, the newest."""
LASTING = 0x3000
"""Smallest code of an alarm that is active until it is cleared; others are single events."""
REFRESH_MS = 2000


class AlarmsPage(FollowingPage):
    """Shows the alarms of the journal and follows it."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        heads = (
            "",
            translate("alarms", "code"),
            translate("alarms", "cause"),
            translate("alarms", "since"),
            translate("alarms", "until"),
            translate("alarms", "acknowledged by"),
        )
        self.table = Table(heads, stretch=2)
        self._actions: dict[object, str] = {}
        """What to do, by number of the alarm's entry in the journal."""
        self.action = label("", "fact", wrap=True)
        self.action.setMinimumHeight(44)
        self.table.itemSelectionChanged.connect(self._on_chosen)
        self.acknowledge = QPushButton(translate("alarms", "Acknowledge"))
        self.acknowledge.clicked.connect(self._acknowledge)
        self._problem = label("", "problem")
        row = QHBoxLayout()
        row.addWidget(
            label(
                translate("alarms", "Choose an alarm and acknowledge it. The journal records who did."),
                "quiet",
            )
        )
        row.addWidget(self._problem)
        row.addStretch(1)
        row.addWidget(self.acknowledge)
        column = QVBoxLayout(self)
        column.addWidget(self.table, 1)
        column.addWidget(titled(translate("alarms", "what to do"), self.action))
        column.addLayout(row)
        self.follow(REFRESH_MS)

    def refresh(self) -> None:
        """Read the journal again and show its alarms."""
        try:
            found = entries(
                self._session.received.folder, (Kind.ALARM, Kind.ALARM_OVER, Kind.ALARM_SEEN), limit=3 * SHOWN
            )
        except RecordError as error:
            self._problem.setText(str(error))
            return
        cleared: dict[str, str] = {}
        acknowledged = {entry.subject: entry.who for entry in found if entry.kind is Kind.ALARM_SEEN}
        rows, numbers, self._actions = [], [], {}
        for entry in found:  # the newest first
            if entry.kind is Kind.ALARM_OVER:
                cleared[entry.subject] = entry.at
            elif entry.kind is Kind.ALARM:
                code = int(entry.subject.removeprefix("16#"), 16)
                lasts = code >= LASTING
                until = cleared.pop(entry.subject, "") if lasts else entry.at
                text = TEXTS.get(code)
                cause = data(text.cause) if text else entry.subject
                cause += f" ({entry.after})" if entry.after else ""
                rows.append(
                    (
                        "" if until else "●",
                        entry.subject,
                        cause,
                        _local(entry.at),
                        (_local(until) if lasts else "") if until else translate("alarms", "active"),
                        acknowledged.get(str(entry.number), ""),
                    )
                )
                numbers.append(entry.number)
                self._actions[entry.number] = data(text.action) if text else ""
        self.table.fill(rows[:SHOWN], numbers[:SHOWN])
        if self.table.chosen() is None and rows:
            self.table.selectRow(0)

    def _on_chosen(self) -> None:
        self.action.setText(self._actions.get(self.table.chosen(), ""))

    def _acknowledge(self) -> None:
        number, user = self.table.chosen(), self._session.account.user
        if user is None:
            self._problem.setText(translate("alarms", "Log in first (page Setup)."))
        elif number is None:
            self._problem.setText(translate("alarms", "Choose an alarm first."))
        else:
            self.acknowledge.setEnabled(False)
            self._session.account.ask(Acknowledge(int(str(number))), self._on_answer, self)

    def _on_answer(self, answer: Answer) -> None:
        self.acknowledge.setEnabled(True)
        self.refresh()
        self._problem.setText(data(answer.refusal) if answer.refusal else "")


def _local(utc: str) -> str:
    return f"{datetime.fromisoformat(utc).astimezone():%d.%m. %H:%M:%S}"

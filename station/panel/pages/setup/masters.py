"""The tab Masters: parts of known verdict, when each was checked, with what result, and when it is due."""

from datetime import UTC, datetime

from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout

from station.archive.reader import Query, Row, find
from station.channel.requests import Answer, CheckMaster
from station.domain import Purpose
from station.errors import RecordError
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.page import FollowingPage
from station.panel.pages.setup.masters_table import MasterState, master_rows
from station.panel.session.session import Session
from station.panel.widgets.card import Table, label, titled

REFRESH_MS = 1500
LOG = 200
"""Maximum number of checks that are shown, the newest."""


class MastersPage(FollowingPage):
    """Shows the masters of the settings and their checks in the archive."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.masters = Table(
            (
                translate("masters", "master"),
                translate("masters", "expected"),
                translate("masters", "result"),
                translate("masters", "last check"),
                translate("masters", "due"),
                translate("masters", "state"),
            ),
            stretch=0,
        )
        self.log = Table(
            (
                translate("masters", "time"),
                translate("masters", "master"),
                translate("masters", "result"),
                translate("masters", "part"),
            ),
            stretch=1,
        )
        self.check = QPushButton(translate("masters", "Check chosen master"))
        self.check.clicked.connect(self._check)
        self.problem = label("", "problem", wrap=True)
        row = QHBoxLayout()
        row.addWidget(
            label(
                translate(
                    "masters",
                    "Insert a master, choose it here and check it. "
                    "The PLC can request the check too (GOLDEN_CHECK).",
                ),
                "quiet",
            )
        )
        row.addStretch(1)
        row.addWidget(self.check)
        column = QVBoxLayout(self)
        column.addWidget(titled(translate("masters", "masters"), self.masters), 1)
        column.addLayout(row)
        column.addWidget(self.problem)
        column.addWidget(titled(translate("masters", "past checks"), self.log), 1)
        session.account.changed.connect(self.refresh)
        self.follow(REFRESH_MS)

    def refresh(self) -> None:
        """Read the checks again and show them."""
        golden = self._session.received.settings.golden
        try:
            rows = find(
                self._session.received.folder, Query(purpose=Purpose.GOLDEN, newest_first=True, limit=LOG)
            )
        except RecordError:
            rows = []  # no archive yet
        states = {
            MasterState.WRONG: "✗ " + translate("masters", "WRONG"),
            MasterState.DUE: "⚠ " + translate("masters", "DUE"),
            MasterState.RIGHT: "✓",
            MasterState.UNKNOWN: "–",
        }
        known = master_rows(golden.masters, golden.due_h, rows, datetime.now(UTC))
        shown = [
            (
                master.serial,
                master.expected,
                master.found or "–",
                _local(master.checked),
                _local(master.due),
                states[master.state],
            )
            for master in known
        ]
        self.masters.fill(shown)
        times = (datetime.fromisoformat(row.grabbed_at).astimezone() for row in rows)
        self.log.fill(
            [
                (f"{at:%d.%m.%Y %H:%M:%S}", row.serial, _judged(row), str(row.inspection_id))
                for at, row in zip(times, rows, strict=True)
            ]
        )
        allowed, problem = self._session.account.may(Level.SETTER), ""
        if not shown:
            problem = translate(
                "masters", "No masters are defined. Add [golden.masters] to the settings file."
            )
        elif not allowed:
            problem = translate("masters", "Log in as setter to check masters.")
        self.check.setEnabled(allowed and bool(shown))
        self.problem.setText(problem)

    def _check(self) -> None:
        row, masters = self.masters.currentRow(), list(self._session.received.settings.golden.masters)
        if not 0 <= row < len(masters):
            self.problem.setText(translate("masters", "Choose a master first."))
            return
        self.check.setEnabled(False)
        self._session.account.ask(CheckMaster(masters[row]), self._on_answer, self)

    def _on_answer(self, answer: Answer) -> None:
        self.refresh()
        if not answer.done:
            self.problem.setText(data(answer.refusal))


def _local(at: datetime | None) -> str:
    return "–" if at is None else f"{at.astimezone():%d.%m. %H:%M}"


def _judged(row: Row) -> str:
    return f"{row.verdict} ({data(row.reason)})" if row.reason else row.verdict

"""Masters: parts known to be good or bad, when they were judged last, when they are due, and how it went."""

from datetime import UTC, datetime

from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout

from station.archive.reader import Row, Wanted, find
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


class MastersPage(FollowingPage):
    """Follows the archive."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.masters = Table(
            (
                translate("masters", "master"),
                translate("masters", "must be"),
                translate("masters", "was judged"),
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
                translate("masters", "was judged"),
                translate("masters", "part"),
            ),
            stretch=1,
        )
        self.check = QPushButton(translate("masters", "Judge the chosen master"))
        self.check.clicked.connect(self._check)
        self.problem = label("", "problem", wrap=True)
        row = QHBoxLayout()
        row.addWidget(
            label(
                translate(
                    "masters",
                    "Put the master in, choose it, judge it. The PLC can ask for it too (GOLDEN_CHECK).",
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
        column.addWidget(titled(translate("masters", "log of the checks"), self.log), 1)
        session.account.changed.connect(self.refresh)
        self.follow(REFRESH_MS)

    def refresh(self) -> None:
        """Read the checks again."""
        golden = self._session.received.settings.golden
        try:
            rows = find(
                self._session.received.folder, Wanted(purpose=Purpose.GOLDEN, newest_first=True, limit=LOG)
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
            (m.serial, m.expected, m.found or "–", _local(m.checked), _local(m.due), states[m.state])
            for m in known
        ]
        self.masters.fill(shown)
        times = (datetime.fromisoformat(row.grabbed_at).astimezone() for row in rows)
        self.log.fill(
            [
                (f"{at:%d.%m.%Y %H:%M:%S}", r.serial, _judged(r), str(r.inspection_id))
                for at, r in zip(times, rows, strict=True)
            ]
        )
        self.check.setEnabled(self._session.account.may(Level.SETTER) and bool(shown))
        none = translate("masters", "no masters are named; write [golden.masters] into the settings file")
        self.problem.setText(
            none
            if not shown
            else ""
            if self._session.account.may(Level.SETTER)
            else translate("masters", "log in as setter to judge")
        )

    def _check(self) -> None:
        row, masters = self.masters.currentRow(), list(self._session.received.settings.golden.masters)
        if not 0 <= row < len(masters):
            self.problem.setText(translate("masters", "choose a master first"))
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

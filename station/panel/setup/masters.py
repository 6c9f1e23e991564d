"""Masters: parts known to be good or bad, when they were judged last, when they are due, and how it went."""

from datetime import datetime, timedelta

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QHBoxLayout, QPushButton, QVBoxLayout

from station.archive.reader import Row, Wanted, find
from station.domain import Purpose
from station.errors import RecordError, WeldgateError
from station.panel.card import Table, label, titled
from station.panel.page import Page
from station.panel.session import Session
from station.panel.words import data, translate
from station.users import Level

REFRESH_MS = 1500
LOG = 200


class MastersPage(Page):
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
            label(translate("masters", "Put the master in, choose it, judge it. The PLC can ask for it too (GOLDEN_CHECK)."), "quiet")
        )
        row.addStretch(1)
        row.addWidget(self.check)
        column = QVBoxLayout(self)
        column.addWidget(titled(translate("masters", "masters"), self.masters), 1)
        column.addLayout(row)
        column.addWidget(self.problem)
        column.addWidget(titled(translate("masters", "log of the checks"), self.log), 1)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._when_seen)
        self._timer.start(REFRESH_MS)
        session.user_changed.connect(self.refresh)
        self.refresh()

    def _when_seen(self) -> None:
        if self.isVisible():
            self.refresh()

    def refresh(self) -> None:
        """Read the checks again."""
        golden = self._session.settings.golden
        try:
            rows = find(self._session.folder, Wanted(purpose=Purpose.GOLDEN, newest_first=True, limit=LOG))
        except RecordError:
            rows = []  # no archive yet
        last: dict[str, Row] = {}
        for row in rows:
            last.setdefault(row.serial, row)
        shown = []
        for serial, must in golden.masters.items():
            check = last.get(serial)
            at = None if check is None else datetime.fromisoformat(check.grabbed_at).astimezone()
            due = None if at is None or golden.due_h is None else at + timedelta(hours=golden.due_h)
            late = golden.due_h is not None and (due is None or due < datetime.now().astimezone())
            wrong = check is not None and check.verdict != must
            state = "✗ " + translate("masters", "WRONG") if wrong else "⚠ " + translate("masters", "DUE") if late else "✓" if check else "–"
            found = "–" if check is None else check.verdict
            shown.append(
                (serial, must, found, "–" if at is None else f"{at:%d.%m. %H:%M}", "–" if due is None else f"{due:%d.%m. %H:%M}", state)
            )
        self.masters.fill(shown)
        times = (datetime.fromisoformat(row.grabbed_at).astimezone() for row in rows)
        self.log.fill([(f"{at:%d.%m.%Y %H:%M:%S}", r.serial, _judged(r), str(r.inspection_id)) for at, r in zip(times, rows, strict=True)])
        self.check.setEnabled(self._session.may(Level.SETTER) and bool(shown))
        none = translate("masters", "no masters are named; write [golden.masters] into the settings file")
        self.problem.setText(
            none if not shown else "" if self._session.may(Level.SETTER) else translate("masters", "log in as setter to judge")
        )

    def _check(self) -> None:
        row, masters = self.masters.currentRow(), list(self._session.settings.golden.masters)
        if not 0 <= row < len(masters):
            self.problem.setText(translate("masters", "choose a master first"))
            return
        try:
            told = self._session.test_picture(masters[row])
        except WeldgateError as error:
            self.problem.setText(data(str(error)))
            return
        if not told:
            self.problem.setText(translate("masters", "no engine is there"))

    def close_page(self) -> None:
        """Stop following."""
        self._timer.stop()


def _judged(row: Row) -> str:
    return f"{row.verdict} ({data(row.reason)})" if row.reason else row.verdict

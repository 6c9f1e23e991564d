"""What people did: changes with their reasons, logins, reviews; it only grows."""

from datetime import datetime

from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout

from station.errors import RecordError
from station.journal.journal import Kind, entries
from station.panel.look.words import data, translate
from station.panel.pages.page import FollowingPage
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label

SHOWN = 500
REFRESH_MS = 2000


class JournalPage(FollowingPage):
    """Follows the journal."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.kind = Choice()
        self.kind.addItem(translate("journal", "everything"), None)
        for kind in Kind:
            self.kind.addItem(data(kind), kind)
        self.table = Table(
            (
                translate("journal", "time"),
                translate("journal", "who"),
                translate("journal", "what"),
                translate("journal", "of"),
                translate("journal", "before"),
                translate("journal", "after"),
                translate("journal", "reason"),
            ),
            stretch=6,
        )
        self._problem = label("", "problem")
        row = QHBoxLayout()
        row.addWidget(self.kind)
        row.addWidget(self._problem)
        row.addStretch(1)
        column = QVBoxLayout(self)
        column.addLayout(row)
        column.addWidget(self.table, 1)
        self.kind.currentIndexChanged.connect(self.refresh)
        self.follow(REFRESH_MS)

    def refresh(self) -> None:
        """Read it again."""
        kind = self.kind.currentData()
        try:
            found = entries(self._session.received.folder, () if kind is None else (kind,), limit=SHOWN)
        except RecordError as error:
            self._problem.setText(str(error))
            return
        rows = []
        for e in found:
            before, after = (
                ("", "") if e.kind is Kind.USER else (e.before, e.after)
            )  # a PIN's hash is nobody's business
            if e.kind is Kind.USER:
                after = translate("journal", "saved") if e.after else translate("journal", "removed")
            when = datetime.fromisoformat(e.at).astimezone()
            rows.append(
                (
                    f"{when:%d.%m.%Y %H:%M:%S}",
                    data(e.who),
                    data(e.kind),
                    data(e.subject),
                    data(before),
                    _said(after),
                    data(e.reason),
                )
            )
        self.table.fill(rows)


def _said(after: str) -> str:
    """In words; an opinion may have segments behind it."""
    word, colon, where = after.partition(": ")
    return f"{data(word)}{colon}{where}" if after else ""

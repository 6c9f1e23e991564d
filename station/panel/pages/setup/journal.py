"""The tab Journal: what people and the station did, with reasons."""

from datetime import datetime

from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout

from station.errors import RecordError
from station.journal.journal import Kind, entries
from station.panel.look.words import data, translate
from station.panel.pages.page import FollowingPage
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label

SHOWN = 500
"""Maximum number of entries that are shown, the newest."""
REFRESH_MS = 2000


class JournalPage(FollowingPage):
    """Shows the journal and follows it."""

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
                translate("journal", "action"),
                translate("journal", "object"),
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
        """Read the journal again and show its entries."""
        kind = self.kind.currentData()
        try:
            found = entries(self._session.received.folder, () if kind is None else (kind,), limit=SHOWN)
        except RecordError as error:
            self._problem.setText(str(error))
            return
        rows = []
        for entry in found:
            before, after = entry.before, _in_words(entry.after)
            if entry.kind is Kind.USER:  # the hash of a PIN is not shown
                before = ""
                after = translate("journal", "saved") if entry.after else translate("journal", "removed")
            when = datetime.fromisoformat(entry.at).astimezone()
            rows.append(
                (
                    f"{when:%d.%m.%Y %H:%M:%S}",
                    data(entry.who),
                    data(entry.kind),
                    data(entry.subject),
                    data(before),
                    after,
                    data(entry.reason),
                )
            )
        self.table.fill(rows)


def _in_words(after: str) -> str:
    """Return a value in the language in use; an opinion may be followed by segments."""
    word, colon, where = after.partition(": ")
    return f"{data(word)}{colon}{where}" if after else ""

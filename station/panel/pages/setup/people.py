"""The tab Users: who may log in, and with which level; for administrators."""

from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

from station.channel.requests import Answer, RemoveUser, SaveUser
from station.errors import RecordError
from station.journal.users import Level, users
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label, titled


class PeoplePage(Page):
    """Lets administrators add, change and remove users."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.table = Table((translate("people", "name"), translate("people", "level")), stretch=0)
        self.name, self.level, self.pin = QLineEdit(), Choice(), QLineEdit()
        self.pin.setEchoMode(QLineEdit.EchoMode.Password)
        for level in Level:
            self.level.addItem(data(level.name.lower()), level)
        self.save, self.remove = (
            QPushButton(translate("people", "Save")),
            QPushButton(translate("people", "Remove")),
        )
        self.problem = label("", "problem", wrap=True)
        box = QWidget()
        form = QFormLayout(box)
        form.addRow(translate("people", "name"), self.name)
        form.addRow(translate("people", "level"), self.level)
        form.addRow(translate("people", "PIN (4 to 12 digits; 6 from quality on)"), self.pin)
        buttons = QHBoxLayout()
        buttons.addWidget(self.save)
        buttons.addWidget(self.remove)
        form.addRow(buttons)
        form.addRow(self.problem)
        right = QVBoxLayout()
        right.addWidget(titled(translate("people", "add or change"), box))
        levels = translate(
            "people",
            "Operator: reviews. Setter: camera, service mode, masters. Quality: limits of the recipes. "
            "Administrator: users. Each level includes the levels before it.",
        )
        right.addWidget(label(levels, "quiet", wrap=True))
        right.addStretch(1)
        row = QHBoxLayout(self)
        row.addWidget(titled(translate("people", "users"), self.table), 1)
        row.addLayout(right, 1)
        self.save.clicked.connect(self._save)
        self.remove.clicked.connect(self._remove)
        self._to_remove = ""
        """Name of the user whose removal has to be confirmed, or empty."""
        self.name.textChanged.connect(self._forget_removal)
        self.table.currentCellChanged.connect(self._on_chosen)
        session.account.changed.connect(self.pin.clear)
        session.account.changed.connect(self._forget_removal)
        session.account.changed.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Read the users again and show them."""
        admin = self._session.account.may(Level.ADMIN)
        for widget in (self.save, self.remove, self.name, self.level, self.pin):
            widget.setEnabled(admin)
        try:
            self.table.fill(
                [(user.name, data(user.level.name.lower())) for user in users(self._session.received.folder)]
            )
            self.problem.setText("" if admin else translate("people", "Log in as administrator first."))
        except RecordError as error:
            self.problem.setText(str(error))

    def _on_chosen(self, row: int) -> None:
        texts = self.table.texts()
        if 0 <= row < len(texts):
            self.name.setText(texts[row][0])
            self.level.setCurrentText(texts[row][1])

    def _save(self) -> None:
        level = Level(self.level.currentData())
        self._ask(SaveUser(self.name.text().strip(), level, self.pin.text()))
        self.pin.clear()

    def _forget_removal(self) -> None:
        self._to_remove = ""
        self.remove.setText(translate("people", "Remove"))

    def _remove(self) -> None:
        name = self.name.text().strip()
        if self._to_remove != name:
            self._to_remove = name
            self.remove.setText(translate("people", "Really remove?"))
            return
        self._forget_removal()
        self._ask(RemoveUser(name))

    def _ask(self, request: SaveUser | RemoveUser) -> None:
        if self._session.account.may(Level.ADMIN):
            for button in (self.save, self.remove):
                button.setEnabled(False)
            self._session.account.ask(request, self._on_answer, self)

    def _on_answer(self, answer: Answer) -> None:
        self._session.account.renew()  # their own level or PIN may have changed
        self.refresh()
        if not answer.done:
            self.problem.setText(data(answer.refusal))

    def close_page(self) -> None:
        """Do nothing: nothing is running."""

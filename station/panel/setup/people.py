"""Who may log in, and at which level; for administrators."""

from collections.abc import Callable

from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

from station.accounts import remove_user, save_user
from station.errors import LoginError, RecordError
from station.panel.card import Choice, Table, label, titled
from station.panel.page import Page
from station.panel.session import Session
from station.panel.words import data, translate
from station.users import Level, users


class PeoplePage(Page):
    """Add, change, remove."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.table = Table((translate("people", "name"), translate("people", "level")), stretch=0)
        self.name, self.level, self.pin = QLineEdit(), Choice(), QLineEdit()
        self.pin.setEchoMode(QLineEdit.EchoMode.Password)
        for level in Level:
            self.level.addItem(data(level.name.lower()), level)
        self.save, self.remove = QPushButton(translate("people", "Save")), QPushButton(translate("people", "Remove"))
        self.problem = label("", "problem", wrap=True)
        box = QWidget()
        form = QFormLayout(box)
        form.addRow(translate("people", "name"), self.name)
        form.addRow(translate("people", "level"), self.level)
        form.addRow(translate("people", "PIN, 4 to 12 digits"), self.pin)
        buttons = QHBoxLayout()
        buttons.addWidget(self.save)
        buttons.addWidget(self.remove)
        form.addRow(buttons)
        form.addRow(self.problem)
        right = QVBoxLayout()
        right.addWidget(titled(translate("people", "add or change"), box))
        levels = translate(
            "people",
            "operator: reviews · setter: camera, service mode, masters · quality: limits of the recipes · administrator: users.\n"
            "Each may do what the ones before may.",
        )
        right.addWidget(label(levels, "quiet", wrap=True))
        right.addStretch(1)
        row = QHBoxLayout(self)
        row.addWidget(titled(translate("people", "known users"), self.table), 1)
        row.addLayout(right, 1)
        self.save.clicked.connect(self._save)
        self.remove.clicked.connect(self._remove)
        self._sure = ""
        """Whose removal was asked for once."""
        self.name.textChanged.connect(self._unsure)
        self.table.currentCellChanged.connect(self._on_chosen)
        session.user_changed.connect(self.pin.clear)
        session.user_changed.connect(self._unsure)
        session.user_changed.connect(self.refresh)
        self.refresh()

    def refresh(self) -> None:
        """Read the users again."""
        admin = self._session.may(Level.ADMIN)
        for widget in (self.save, self.remove, self.name, self.level, self.pin):
            widget.setEnabled(admin)
        try:
            self.table.fill([(user.name, data(user.level.name.lower())) for user in users(self._session.folder)])
            self.problem.setText("" if admin else translate("people", "log in as administrator first"))
        except RecordError as error:
            self.problem.setText(str(error))

    def _on_chosen(self, row: int) -> None:
        texts = self.table.texts()
        if 0 <= row < len(texts):
            self.name.setText(texts[row][0])
            self.level.setCurrentText(texts[row][1])

    def _save(self) -> None:
        self._do(lambda by: save_user(self._session.folder, by, self.name.text(), self.level.currentData(), self.pin.text()))
        self.pin.clear()

    def _unsure(self) -> None:
        self._sure = ""
        self.remove.setText(translate("people", "Remove"))

    def _remove(self) -> None:
        name = self.name.text().strip()
        if self._sure != name:
            self._sure = name
            self.remove.setText(translate("people", "Really remove?"))
            return
        self._unsure()
        self._do(lambda by: remove_user(self._session.folder, by, name))

    def _do(self, work: Callable[[str], object]) -> None:
        user = self._session.user
        if user is None or not self._session.may(Level.ADMIN):
            return
        try:
            work(user.name)
        except (LoginError, RecordError) as error:
            self.problem.setText(data(str(error)))
            return
        if self.name.text().strip() == user.name:  # their own level or PIN
            self._session.log_out("user changed")
        self.refresh()

    def close_page(self) -> None:
        """Nothing runs."""

"""The tab Login: name and PIN, with keys that can be used with gloves.

A commissioning code makes a new name an administrator, above all the first one.
"""

from PySide6.QtCore import Qt
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import (
    QFormLayout,
    QGridLayout,
    QHBoxLayout,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from station.channel.requests import Answer
from station.errors import RecordError
from station.journal.users import User, users
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.pages.setup.login_view import Notice, login_view, needs_code, notice
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, label, titled


class LoginPage(Page):
    """Logs users in and out."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.name, self.pin, self.code = Choice(), QLineEdit(), QLineEdit()
        self._known: tuple[User, ...] = ()
        self.name.setEditable(True)
        self.name.setMinimumWidth(260)
        self.pin.setEchoMode(QLineEdit.EchoMode.Password)
        self.pin.setMaxLength(12)
        self.code.setMaxLength(14)
        self.name.currentTextChanged.connect(self._on_name)
        self.log_in, self.log_out = (
            QPushButton(translate("login", "Log in")),
            QPushButton(translate("login", "Log out")),
        )
        self.log_in.clicked.connect(self._log_in)
        self.pin.returnPressed.connect(self._log_in)
        self.log_out.clicked.connect(session.account.log_out)
        self._who, self.problem = label("", "title"), label("", "problem", wrap=True)
        form_box = QWidget()
        self._form = form = QFormLayout(form_box)
        form.addRow(translate("login", "name"), self.name)
        form.addRow(translate("login", "commissioning code"), self.code)
        form.addRow(translate("login", "PIN"), self.pin)
        keys = QGridLayout()
        for index, key in enumerate("123456789⌫0↵"):
            button = QPushButton(key)
            button.setMinimumSize(72, 56)
            button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            button.clicked.connect(lambda _=False, pressed=key: self._press(pressed))
            keys.addWidget(button, index // 3, index % 3)
        form.addRow(keys)
        buttons = QHBoxLayout()
        buttons.addWidget(self.log_in)
        buttons.addWidget(self.log_out)
        form.addRow(buttons)
        self._hint = label("", "quiet", wrap=True)
        column = QVBoxLayout()
        column.addWidget(self._who)
        column.addWidget(titled(translate("login", "Log in"), form_box))
        column.addWidget(self.problem)
        column.addWidget(self._hint)
        column.addStretch(1)
        row = QHBoxLayout(self)
        row.addStretch(1)
        row.addLayout(column)
        row.addStretch(1)
        session.account.changed.connect(self._on_user)
        self._on_user()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        """Read the users again, as some may have been added meanwhile."""
        self._on_user()
        super().showEvent(event)

    def _press(self, key: str) -> None:
        field = self.code if self.code.hasFocus() else self.pin
        if key == "⌫":
            field.backspace()
        elif key == "↵":
            self._log_in()
        else:
            field.insert(key)

    def _on_name(self, name: str) -> None:
        self._form.setRowVisible(self.code, needs_code(self._known, name.strip()))

    def _on_user(self) -> None:
        user = self._session.account.user
        self.pin.clear()
        self.log_out.setEnabled(user is not None)
        self.problem.setText("")
        self._who.setText(
            translate("login", "Nobody is logged in.")
            if user is None
            else f"{user.name} · {data(user.level.name.lower())}"
        )
        try:
            self._known = known = tuple(users(self._session.received.folder))
        except RecordError as error:
            self.problem.setText(str(error))
            return
        view = login_view(known, self.name.currentText())
        self.log_in.setText(
            translate("login", "Become administrator") if view.first else translate("login", "Log in")
        )
        self._hint.setText(
            translate(
                "login",
                "There are no users yet. 'weldgate commission' on this computer shows a code; with it, enter "
                "a name and a PIN of 6 to 12 digits to become administrator.",
            )
            if view.first
            else translate(
                "login",
                "Anyone can watch; every action needs a login. Five wrong PINs lock a user for one minute.",
            )
        )
        self.name.clear()
        self.name.addItems(view.names)
        self.name.setEditText(view.chosen)
        self._on_name(view.chosen)

    def _log_in(self) -> None:
        name, pin = self.name.currentText().strip(), self.pin.text()
        code = self.code.text().strip() if needs_code(self._known, name) else ""
        self.pin.clear()
        self.log_in.setEnabled(False)
        self._session.account.log_in(name, pin, self._on_answer, self, code=code)

    def _on_answer(self, answer: Answer) -> None:
        self.log_in.setEnabled(True)
        if answer.done:
            self.code.clear()
        if notice(answer) is Notice.LOCKED:
            self.problem.setText(translate("login", "Locked for one minute after five wrong PINs."))
        elif notice(answer) is Notice.REFUSED:
            self.problem.setText(data(answer.refusal))

    def close_page(self) -> None:
        """Do nothing: nothing is running."""

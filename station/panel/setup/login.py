"""Who is there: name and PIN, with keys for gloves; the first user of a station becomes its administrator."""

from PySide6.QtCore import Qt
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QFormLayout, QGridLayout, QHBoxLayout, QLineEdit, QPushButton, QVBoxLayout, QWidget

from station.accounts import log_in, save_user
from station.errors import LoginError, RecordError
from station.panel.card import Choice, label, titled
from station.panel.page import Page
from station.panel.session import Session
from station.panel.words import data, translate
from station.users import Level, users


class LoginPage(Page):
    """Log in and out."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.name, self.pin = Choice(), QLineEdit()
        self.name.setEditable(True)
        self.name.setMinimumWidth(260)
        self.pin.setEchoMode(QLineEdit.EchoMode.Password)
        self.pin.setMaxLength(12)
        self.log_in, self.log_out = QPushButton(translate("login", "Log in")), QPushButton(translate("login", "Log out"))
        self.log_in.clicked.connect(self._log_in)
        self.pin.returnPressed.connect(self._log_in)
        self.log_out.clicked.connect(lambda: session.log_out("asked to"))
        self._who, self.problem = label("", "title"), label("", "problem", wrap=True)
        form_box = QWidget()
        form = QFormLayout(form_box)
        form.addRow(translate("login", "name"), self.name)
        form.addRow(translate("login", "PIN"), self.pin)
        keys = QGridLayout()
        for index, key in enumerate("123456789⌫0↵"):
            button = QPushButton(key)
            button.setMinimumSize(72, 56)
            button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
            button.clicked.connect(lambda _=False, k=key: self._key(k))
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
        session.user_changed.connect(self._on_user)
        self._on_user()

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        """Users may have come meanwhile."""
        self._on_user()
        super().showEvent(event)

    def _key(self, key: str) -> None:
        if key == "⌫":
            self.pin.backspace()
        elif key == "↵":
            self._log_in()
        else:
            self.pin.insert(key)

    def _on_user(self) -> None:
        user = self._session.user
        self.pin.clear()
        self.log_out.setEnabled(user is not None)
        self.problem.setText("")
        self._who.setText(translate("login", "nobody is logged in") if user is None else f"{user.name} · {data(user.level.name.lower())}")
        try:
            known = users(self._session.folder)
        except RecordError as error:
            self.problem.setText(str(error))
            return
        first = not known
        self.log_in.setText(translate("login", "Become administrator") if first else translate("login", "Log in"))
        self._hint.setText(
            translate("login", "Nobody is known yet: whoever gives a name and a PIN of at least 4 digits becomes administrator.")
            if first
            else translate("login", "Watching needs no login, doing does. Five wrong PINs lock a name for a minute.")
        )
        chosen = self.name.currentText()
        self.name.clear()
        self.name.addItems([user.name for user in known])
        self.name.setEditText(chosen or (known[0].name if known else ""))

    def _log_in(self) -> None:
        name, pin = self.name.currentText().strip(), self.pin.text()
        self.pin.clear()
        folder = self._session.folder
        try:
            if not users(folder):
                save_user(folder, name, name, Level.ADMIN, pin)
            user = log_in(folder, name, pin)
        except LoginError as error:
            self.problem.setText(
                translate("login", "locked for a minute after five wrong PINs") if error.locked_s else data(str(error).split(";")[0])
            )
            return
        except RecordError as error:
            self.problem.setText(str(error))
            return
        self._session.log_in(user)

    def close_page(self) -> None:
        """Nothing runs."""

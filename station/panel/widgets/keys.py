"""A keyboard on the screen, which types where the cursor is."""

from PySide6.QtCore import QEvent, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QApplication, QGridLayout, QPushButton, QSizePolicy, QWidget

from station.panel.look import words

ROWS = {
    "en": ("1234567890-", "qwertyuiop/", "asdfghjkl:;", "zxcvbnm,.*_"),
    "de": ("1234567890ß", "qwertzuiopü", "asdfghjklöä", "yxcvbnm,.-:"),
}
SHIFT, BACK, SPACE, ENTER = "⇧", "⌫", "␣", "↵"
CODES: dict[str, Qt.Key] = {BACK: Qt.Key.Key_Backspace, ENTER: Qt.Key.Key_Return, SPACE: Qt.Key.Key_Space}


class Keys(QWidget):
    """Shows the keys of the language in use; never takes the focus."""

    def __init__(self) -> None:
        super().__init__()
        self._letters: list[QPushButton] = []
        grid = QGridLayout(self)
        grid.setContentsMargins(8, 0, 8, 6)
        grid.setSpacing(4)
        rows = ROWS[words.language()]
        for row, keys in enumerate(rows):
            for column, key in enumerate(keys):
                self._letters.append(self._key(key))
                grid.addWidget(self._letters[-1], row, column)
        self.shift = self._key(SHIFT)
        self.shift.setCheckable(True)
        self.shift.toggled.connect(self._shift)
        for row, button in enumerate((self._key(BACK), self._key(ENTER), self.shift, self._key(SPACE))):
            grid.addWidget(button, row, len(rows[0]))
        for column in range(len(rows[0])):
            grid.setColumnStretch(column, 2)
        grid.setColumnStretch(len(rows[0]), 3)

    def _key(self, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName("key")
        button.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        if text != SHIFT:
            button.setAutoRepeat(text == BACK)
            button.clicked.connect(lambda: self._press(button.text()))
        return button

    def _shift(self, up: bool) -> None:
        for button in self._letters:
            button.setText(button.text().upper() if up and button.text() != "ß" else button.text().lower())

    def _press(self, key: str) -> None:
        place = QApplication.focusWidget()
        if place is None:
            return
        text = {BACK: "", ENTER: "\r", SPACE: " "}.get(key, key)
        for kind in (QEvent.Type.KeyPress, QEvent.Type.KeyRelease):
            QApplication.sendEvent(
                place,
                QKeyEvent(kind, CODES.get(key, Qt.Key.Key_unknown), Qt.KeyboardModifier.NoModifier, text),
            )
        self.shift.setChecked(False)

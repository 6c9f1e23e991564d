"""Small widgets that all pages are built from."""

from collections.abc import Sequence

from PySide6.QtCore import Qt
from PySide6.QtWidgets import (
    QAbstractItemView,
    QAbstractScrollArea,
    QComboBox,
    QFrame,
    QGridLayout,
    QHeaderView,
    QLabel,
    QListView,
    QScrollArea,
    QScroller,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

TOUCH_PX = 44
"""Minimum height of what is touched."""


def label(text: str, name: str = "", wrap: bool = False) -> QLabel:
    """Return a label; `name` is one of the style sheet's kinds of label."""
    made = QLabel(text)
    made.setObjectName(name)
    made.setWordWrap(wrap)
    return made


class Facts(QFrame):
    """A card with names and their values."""

    def __init__(self, names: dict[str, str], columns: int = 1, big: Sequence[str] = ()) -> None:
        """`names` are the labels by key; the values of the keys in `big` are shown larger."""
        super().__init__()
        self.setObjectName("card")
        grid = QGridLayout(self)
        grid.setVerticalSpacing(3)
        self.values: dict[str, QLabel] = {}
        rows = -(-len(names) // columns)
        for index, (key, name) in enumerate(names.items()):
            row, column = index % rows, index // rows * 2
            grid.addWidget(label(name, "quiet"), row, column)
            self.values[key] = label("–", "value" if key in big else "fact")
            grid.addWidget(self.values[key], row, column + 1)
            grid.setColumnStretch(column + 1, 1)

    def set(self, **values: object) -> None:
        """Set the values of some keys."""
        for key, value in values.items():
            self.values[key].setText(str(value))


def titled(title: str, inside: QWidget) -> QFrame:
    """Return a card with a title."""
    card = QFrame()
    card.setObjectName("card")
    if type(inside) is QWidget:
        inside.setObjectName("plain")
    column = QVBoxLayout(card)
    column.setContentsMargins(10, 8, 10, 10)
    column.addWidget(label(title, "quiet"))
    column.addWidget(inside, 1)
    return card


def scrolled(page: QWidget) -> QScrollArea:
    """Return a scroll area around a page that may be larger than its place."""
    area = QScrollArea()
    area.setWidgetResizable(True)
    area.setWidget(page)
    by_finger(area)
    return area


def by_finger(area: QAbstractScrollArea) -> None:
    """Let a finger scroll an area."""
    QScroller.grabGesture(area.viewport(), QScroller.ScrollerGestureType.TouchGesture)


class Choice(QComboBox):
    """A combo box whose entries can be touched with gloves."""

    def __init__(self) -> None:
        super().__init__()
        self.setView(QListView())  # the style sheet sets the height of its rows


class Table(QTableWidget):
    """A table of texts in which one row can be chosen."""

    def __init__(self, heads: Sequence[str], stretch: int = -1) -> None:
        super().__init__(0, len(heads))
        self._keys: list[object] = []
        self.setHorizontalHeaderLabels(list(heads))
        self.verticalHeader().hide()
        self.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
        self.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setAlternatingRowColors(True)
        self.setShowGrid(False)
        self.setWordWrap(False)
        self.verticalHeader().setDefaultSectionSize(TOUCH_PX)
        by_finger(self)
        header = self.horizontalHeader()
        header.setDefaultAlignment(Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter)
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(stretch % len(heads), QHeaderView.ResizeMode.Stretch)

    def fill(self, rows: Sequence[Sequence[str]], keys: Sequence[object] = ()) -> None:
        """Show other rows; if each has a key, the chosen row stays chosen wherever it is now."""
        chosen = self.chosen() if keys else None
        self._keys = list(keys)
        self.setRowCount(len(rows))
        for index, row in enumerate(rows):
            for column, text in enumerate(row):
                item = self.item(index, column)
                if item is None:
                    self.setItem(index, column, QTableWidgetItem(text))
                elif item.text() != text:
                    item.setText(text)
        if chosen is not None and chosen in self._keys:
            self.selectRow(self._keys.index(chosen))
        elif chosen is not None or self.currentRow() >= len(rows):
            self.setCurrentCell(-1, -1)
            self.clearSelection()

    def chosen(self) -> object | None:
        """Return the key of the chosen row, or None."""
        return self._keys[self.currentRow()] if 0 <= self.currentRow() < len(self._keys) else None

    def texts(self) -> list[list[str]]:
        """Return the texts of all rows."""
        return [
            [item.text() if (item := self.item(row, column)) else "" for column in range(self.columnCount())]
            for row in range(self.rowCount())
        ]

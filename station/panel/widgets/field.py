"""A number to be set: refused at the field if it is none or out of range, and the range is named."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QLineEdit, QWidget

from station.panel.look.words import translate
from station.panel.widgets.card import label


class NumberField(QWidget):
    """Text field with its range and what is wrong behind it."""

    changed = Signal()

    def __init__(self, low: float, high: float, unit: str = "") -> None:
        super().__init__()
        self._low, self._high = low, high
        self.edit, self._said = QLineEdit(), label("", "quiet")
        self.edit.setFixedWidth(110)
        self._range = f"{low:.7g} … {high:.7g} {unit}".strip()
        row = QGridLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.edit, 0, 0)
        row.addWidget(self._said, 0, 1)
        row.setColumnStretch(1, 1)
        self.edit.textChanged.connect(self._look)
        self._look()

    @property
    def value(self) -> float | None:
        """None: not a number in the range."""
        try:
            number = float(self.edit.text().replace(",", "."))
        except ValueError:
            return None
        return number if self._low <= number <= self._high else None

    @property
    def problem(self) -> str:
        """What stands behind the field if the value is refused."""
        return "" if self.value is not None else self._said.text()

    def set(self, value: float) -> None:
        """Show a number."""
        self.edit.setText(f"{value:.6g}")

    def _look(self) -> None:
        good = self.value is not None
        self._said.setObjectName("quiet" if good else "problem")
        self._said.setText(self._range if good else translate("field", "allowed: ") + self._range)
        self._said.style().unpolish(self._said)
        self._said.style().polish(self._said)
        self.changed.emit()


class SegmentLimits(QWidget):
    """Limits of single segments as text: 1: 0.6, 12: 0.3."""

    changed = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.edit, self._said = QLineEdit(), label("", "problem")
        self.edit.setPlaceholderText("1: 0.6, 12: 0.3")
        self.edit.setMaximumWidth(220)
        row = QGridLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.edit, 0, 0)
        row.addWidget(self._said, 1, 0)
        self._said.hide()
        self.edit.textChanged.connect(self._look)

    @property
    def value(self) -> dict[int, float] | None:
        """By number, 1 to 21; None: not to be read, or not allowed."""
        found: dict[int, float] = {}
        for part in filter(None, (text.strip() for text in self.edit.text().replace(";", ",").split(","))):
            number, _, limit = part.partition(":")
            try:
                found[int(number)] = float(limit)
            except ValueError:
                return None
        return found if all(1 <= n <= 21 and 0.01 <= limit <= 0.99 for n, limit in found.items()) else None

    def set(self, limits: dict[int, float]) -> None:
        """Show limits."""
        self.edit.setText(", ".join(f"{number}: {limit:g}" for number, limit in sorted(limits.items())))

    def _look(self) -> None:
        self._said.setText(translate("field", "allowed: ") + "1 … 21: 0.01 … 0.99")
        self._said.setVisible(self.value is None)
        self.changed.emit()

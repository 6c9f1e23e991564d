"""Fields for numbers, which show their range and refuse what is not a number in it."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QGridLayout, QLineEdit, QWidget

from station.domain import SEGMENTS
from station.numbers import number, numbered
from station.panel.look.words import translate
from station.panel.widgets.card import label

LOW, HIGH = 0.01, 0.99
"""Range of a threshold."""


class NumberField(QWidget):
    """A text field for one number, followed by its range."""

    changed = Signal()
    """Emitted when the text has changed."""

    def __init__(self, low: float, high: float, unit: str = "") -> None:
        super().__init__()
        self._low, self._high = low, high
        self.edit, self._note = QLineEdit(), label("", "quiet")
        self.edit.setFixedWidth(110)
        self._range = f"{low:.7g} … {high:.7g} {unit}".strip()
        row = QGridLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.edit, 0, 0)
        row.addWidget(self._note, 0, 1)
        row.setColumnStretch(1, 1)
        self.edit.textChanged.connect(self._on_changed)
        self._on_changed()

    @property
    def value(self) -> float | None:
        """Number in the field, or None if it is not a number in the range."""
        try:
            value = number(self.edit.text())
        except ValueError:
            return None
        return value if self._low <= value <= self._high else None

    @property
    def problem(self) -> str:
        """Text after the field if the value is refused, or empty."""
        return "" if self.value is not None else self._note.text()

    def set(self, value: float) -> None:
        """Put a number into the field."""
        self.edit.setText(f"{value:.6g}")

    def _on_changed(self) -> None:
        allowed = self.value is not None
        self._note.setObjectName("quiet" if allowed else "problem")
        self._note.setText(self._range if allowed else translate("field", "allowed: ") + self._range)
        self._note.style().unpolish(self._note)
        self._note.style().polish(self._note)
        self.changed.emit()


class SegmentLimits(QWidget):
    """A text field for thresholds of single segments, such as 1: 0.6, 12: 0.3."""

    changed = Signal()
    """Emitted when the text has changed."""

    def __init__(self) -> None:
        super().__init__()
        self.edit, self._note = QLineEdit(), label("", "problem")
        self.edit.setPlaceholderText("1: 0.6, 12: 0.3")
        self.edit.setMaximumWidth(220)
        row = QGridLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.edit, 0, 0)
        row.addWidget(self._note, 1, 0)
        self._note.hide()
        self.edit.textChanged.connect(self._on_changed)

    @property
    def value(self) -> dict[int, float] | None:
        """Thresholds by number of the segment, 1 to 21, or None if the text is not valid."""
        try:
            found = numbered(self.edit.text())
        except ValueError:
            return None
        return found if all(_allowed(segment, limit) for segment, limit in found.items()) else None

    def set(self, limits: dict[int, float]) -> None:
        """Put thresholds into the field."""
        self.edit.setText(", ".join(f"{number}: {limit:g}" for number, limit in sorted(limits.items())))

    def _on_changed(self) -> None:
        self._note.setText(
            translate("field", "allowed, each segment once: ") + f"1 … {SEGMENTS}: {LOW:g} … {HIGH:g}"
        )
        self._note.setVisible(self.value is None)
        self.changed.emit()


def _allowed(segment: int, limit: float) -> bool:
    return 1 <= segment <= SEGMENTS and LOW <= limit <= HIGH

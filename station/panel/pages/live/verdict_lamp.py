"""The verdict lamp: word, symbol and colour, readable from five metres; below it the part and its age."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from station.panel.look import theme
from station.panel.look.words import data
from station.panel.session.lamp import OFFLINE, Lamp, Tone


class VerdictLamp(QWidget):
    """Shows one `Lamp`."""

    def __init__(self) -> None:
        super().__init__()
        self._lamp, self._foot = OFFLINE, ""
        self.setMinimumSize(300, 190)

    @property
    def lamp(self) -> Lamp:
        """State that is shown."""
        return self._lamp

    def show_lamp(self, lamp: Lamp, foot: str = "") -> None:
        """Show a state; `foot` is the line below it: part and age."""
        if (lamp, foot) != (self._lamp, self._foot):
            self._lamp, self._foot = lamp, foot
            self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw the lamp."""
        colors = theme.colors()
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        lit = self._lamp.tone is not Tone.QUIET
        strength = self._lamp.strength if lit else 0.0
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(_mix(getattr(colors, self._lamp.tone), colors.surface, strength))
        painter.drawRoundedRect(QRectF(self.rect()), 10, 10)
        text_color = colors.on_bad if self._lamp.tone is Tone.BAD else colors.on_color
        painter.setPen(QColor(text_color if lit and strength > 0.6 else colors.text))
        height, width = self.height(), self.width()
        font, word = painter.font(), data(self._lamp.word)
        font.setBold(True)
        for text, top, part, size in ((self._lamp.symbol, 0.02, 0.34, 0.32), (word, 0.35, 0.32, 0.31)):
            font.setPixelSize(max(12, int(min(height * size, width * 1.15 / max(4, len(text))))))
            painter.setFont(font)
            painter.drawText(
                QRectF(0, height * top, width, height * part), Qt.AlignmentFlag.AlignCenter, text
            )
        font.setBold(False)
        font.setPixelSize(16)
        painter.setFont(font)
        flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
        detail = ": ".join(
            text for text in (data(self._lamp.detail) if self._lamp.detail else "", self._lamp.more) if text
        )
        painter.drawText(QRectF(10, height * 0.67, width - 20, height * 0.2), int(flags), detail)
        painter.drawText(
            QRectF(10, height * 0.85, width - 20, height * 0.13), Qt.AlignmentFlag.AlignCenter, self._foot
        )


def _mix(over: str, under: str, strength: float) -> QColor:
    """Return the first colour laid over the second one; `strength` 1: only the first, 0: only the second."""
    top, bottom = QColor(over), QColor(under)
    pairs = ((top.red(), bottom.red()), (top.green(), bottom.green()), (top.blue(), bottom.blue()))
    return QColor(*(round(x * strength + y * (1 - strength)) for x, y in pairs))

"""The big answer: word, symbol and colour, readable from five metres."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from station.panel import theme
from station.panel.lamp_state import Lamp


class VerdictLamp(QWidget):
    """Paints one `Lamp`."""

    def __init__(self) -> None:
        super().__init__()
        self._lamp = Lamp("OFFLINE", "○", theme.QUIET, 1.0, "")
        self.setMinimumSize(300, 230)

    def show_lamp(self, lamp: Lamp) -> None:
        """Show another state."""
        if lamp != self._lamp:
            self._lamp = lamp
            self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw the lamp."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        lit = self._lamp.color != theme.QUIET
        color = _mix(self._lamp.color, theme.SURFACE, self._lamp.strength if lit else 0.0)
        painter.setPen(Qt.PenStyle.NoPen)
        painter.setBrush(color)
        painter.drawRoundedRect(QRectF(self.rect()), 10, 10)
        painter.setPen(QColor("#101214") if lit and self._lamp.strength > 0.5 else QColor(theme.TEXT))
        height, width = self.height(), self.width()
        font = painter.font()
        font.setBold(True)
        for text, top, share, size in ((self._lamp.symbol, 0.04, 0.42, 0.36), (self._lamp.word, 0.46, 0.28, 0.24)):
            font.setPixelSize(max(12, int(min(height * size, width * 1.15 / max(4, len(text))))))
            painter.setFont(font)
            painter.drawText(QRectF(0, height * top, width, height * share), Qt.AlignmentFlag.AlignCenter, text)
        font.setBold(False)
        font.setPixelSize(16)
        painter.setFont(font)
        flags = Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap
        painter.drawText(QRectF(10, height * 0.74, width - 20, height * 0.24), int(flags), self._lamp.detail)


def _mix(over: str, under: str, strength: float) -> QColor:
    a, b = QColor(over), QColor(under)
    pairs = ((a.red(), b.red()), (a.green(), b.green()), (a.blue(), b.blue()))
    return QColor(*(round(x * strength + y * (1 - strength)) for x, y in pairs))

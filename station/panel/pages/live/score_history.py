"""The scores of one segment over the newest parts."""

from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from station.panel.look import theme

FOOT_PX = 22


class ScoreHistory(QWidget):
    """Shows one dot for each part, the oldest at the left; rejected segments are red."""

    touched = Signal()
    """Emitted when the chart is touched."""

    def __init__(self) -> None:
        super().__init__()
        self.scores: tuple[float, ...] = ()
        self._nok: tuple[bool, ...] = ()
        self._foot = ""
        self.setMinimumSize(170, 170)

    def show_scores(self, scores: Sequence[float], nok: Sequence[bool], foot: str) -> None:
        """Show the score of NOK, 0 to 1, of each part and whether it was rejected, and the text `foot`."""
        self.scores, self._nok, self._foot = tuple(scores), tuple(nok), foot
        self.update()

    def mousePressEvent(self, _event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Emit `touched`."""
        self.touched.emit()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw lines at 0, 0.5 and 1, then the dots."""
        colors, painter = theme.colors(), QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        font = painter.font()
        font.setPixelSize(12)
        painter.setFont(font)
        field = QRectF(34, 8, self.width() - 46, self.height() - FOOT_PX - 18)
        for level in (0.0, 0.5, 1.0):
            y = field.bottom() - level * field.height()
            painter.setPen(QPen(QColor(colors.line), 1))
            painter.drawLine(QPointF(field.left(), y), QPointF(field.right(), y))
            painter.setPen(QColor(colors.quiet))
            painter.drawText(
                QRectF(0, y - 8, 28, 16),
                int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter),
                f"{level:.1f}",
            )
        painter.setPen(Qt.PenStyle.NoPen)
        step = field.width() / max(1, len(self.scores) - 1)
        for index, (score, nok) in enumerate(zip(self.scores, self._nok, strict=True)):
            at = QPointF(field.left() + index * step, field.bottom() - score * field.height())
            painter.setBrush(QColor(colors.bad if nok else colors.quiet))
            painter.drawEllipse(at, 4.5 if nok else 2.5, 4.5 if nok else 2.5)
        painter.setPen(QColor(colors.text))
        painter.drawText(
            QRectF(0, self.height() - FOOT_PX, self.width(), FOOT_PX),
            Qt.AlignmentFlag.AlignCenter,
            self._foot,
        )

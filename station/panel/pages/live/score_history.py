"""How the score of one segment went over the last parts."""

from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from station.panel.look import theme

FOOT_PX = 22


class ScoreHistory(QWidget):
    """One dot a part, the oldest at the left, 0 at the bottom, 1 at the top, refused ones marked; a touch says that it was seen."""

    touched = Signal()

    def __init__(self) -> None:
        super().__init__()
        self.scores: tuple[float, ...] = ()
        self._nok: tuple[bool, ...] = ()
        self._foot = ""
        self.setMinimumSize(170, 170)

    def show_scores(self, scores: Sequence[float], nok: Sequence[bool], foot: str) -> None:
        """Scores of NOK, 0 to 1, and whether the segment was refused, one of each a part; `foot`: what stands below."""
        self.scores, self._nok, self._foot = tuple(scores), tuple(nok), foot
        self.update()

    def mousePressEvent(self, _event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Seen."""
        self.touched.emit()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw lines at 0, 0.5 and 1, then the dots."""
        c, painter = theme.colors(), QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        font = painter.font()
        font.setPixelSize(12)
        painter.setFont(font)
        field = QRectF(34, 8, self.width() - 46, self.height() - FOOT_PX - 18)
        for level in (0.0, 0.5, 1.0):
            y = field.bottom() - level * field.height()
            painter.setPen(QPen(QColor(c.line), 1))
            painter.drawLine(QPointF(field.left(), y), QPointF(field.right(), y))
            painter.setPen(QColor(c.quiet))
            painter.drawText(
                QRectF(0, y - 8, 28, 16),
                int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter),
                f"{level:.1f}",
            )
        painter.setPen(Qt.PenStyle.NoPen)
        step = field.width() / max(1, len(self.scores) - 1)
        for index, (score, nok) in enumerate(zip(self.scores, self._nok, strict=True)):
            at = QPointF(field.left() + index * step, field.bottom() - score * field.height())
            painter.setBrush(QColor(c.bad if nok else c.quiet))
            painter.drawEllipse(at, 4.5 if nok else 2.5, 4.5 if nok else 2.5)
        painter.setPen(QColor(c.text))
        painter.drawText(
            QRectF(0, self.height() - FOOT_PX, self.width(), FOOT_PX),
            Qt.AlignmentFlag.AlignCenter,
            self._foot,
        )

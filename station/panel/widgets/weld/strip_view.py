"""The unwrapped weld with its 21 cells and their scores; over it, on demand, where the network sees defects."""

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from station.domain import SEGMENTS
from station.panel.look import theme

LABEL_PX = 36


class StripView(QWidget):
    """Strip on top, one cell a segment below it; a cell can be touched."""

    touched = Signal(int)
    """Index of the segment, 0 to 20."""

    def __init__(self, height_px: int = 130) -> None:
        super().__init__()
        self._image: QImage | None = None
        self._map: QImage | None = None
        self._scores: tuple[float, ...] = ()
        self._nok: tuple[bool, ...] = ()
        self._marks: dict[int, str] = {}
        self.setMinimumHeight(height_px)

    def show_strip(self, image: QImage | None, scores: tuple[float, ...], nok: tuple[bool, ...]) -> None:
        """`image`: None if there is no picture; scores of NOK."""
        self._image, self._scores, self._nok, self._map = image, scores, nok, None
        self.update()

    def show_map(self, overlay: QImage) -> None:
        """ARGB picture over the strip."""
        self._map = overlay
        self.update()

    def show_marks(self, marks: dict[int, str]) -> None:
        """Words in the cells of some segments, by number."""
        self._marks = marks
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Which cell."""
        self.touched.emit(
            min(SEGMENTS - 1, max(0, int(event.position().x() * SEGMENTS / max(1, self.width()))))
        )

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw strip and cells."""
        c, painter = theme.colors(), QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        picture = QRectF(0, 0, self.width(), self.height() - LABEL_PX)
        painter.fillRect(picture, QColor(c.picture))
        for layer in (self._image, self._map):
            if layer is not None and not layer.isNull():
                painter.drawImage(picture, layer)
        width = self.width() / SEGMENTS
        font = painter.font()
        for index in range(SEGMENTS):
            nok = index < len(self._nok) and self._nok[index]
            cell = QRectF(index * width, picture.height(), width, LABEL_PX)
            painter.fillRect(cell, QColor(c.bad if nok else c.surface))
            painter.setPen(QPen(QColor(c.line), 1))
            painter.drawRect(QRectF(index * width, 0, width, self.height() - 1))
            painter.setPen(QColor(c.on_bad if nok else c.text))
            font.setPixelSize(12)
            font.setBold(nok)
            painter.setFont(font)
            score = f"\n{self._scores[index]:.2f}" if index < len(self._scores) else ""
            mark = "✗" if nok else ""
            painter.drawText(cell, Qt.AlignmentFlag.AlignCenter, f"{mark}{index + 1}{score}")
            inside = QRectF(index * width + 2, 2, width - 4, picture.height() - 4)
            if nok:
                painter.setPen(QPen(QColor("#ff5a4f"), 3))
                painter.drawRect(inside)
            if index + 1 in self._marks:
                painter.setPen(QPen(QColor(c.warn), 3))
                painter.drawRect(inside)
                painter.fillRect(inside, QColor(16, 18, 20, 150))
                painter.setPen(QColor("#ffcf4a"))
                font.setPixelSize(11)
                painter.setFont(font)
                flags = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
                painter.drawText(inside, flags, self._marks[index + 1])

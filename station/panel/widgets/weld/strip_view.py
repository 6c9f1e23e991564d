"""The strip with its 21 segments and their scores; the defect map can be laid over it."""

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QColor, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from station.domain import SEGMENTS
from station.panel.look import theme
from station.panel.widgets.weld.weld_view import RED, SHADE, YELLOW

LABEL_PX = 36


class StripView(QWidget):
    """Shows the strip, and below it one cell for each segment; a segment can be touched."""

    touched = Signal(int)
    """Carries the index of the touched segment, 0 to 20."""

    def __init__(self, height_px: int = 130) -> None:
        super().__init__()
        self._image: QImage | None = None
        self.overlay: QImage | None = None
        """Defect map over the strip, or None."""
        self.scores: tuple[float, ...] = ()
        self._nok: tuple[bool, ...] = ()
        self._marks: dict[int, str] = {}
        self.setMinimumHeight(height_px)

    def show_strip(self, image: QImage | None, scores: tuple[float, ...], nok: tuple[bool, ...]) -> None:
        """Show a strip, or none, with the score of NOK of each segment and whether it was rejected."""
        self._image, self.scores, self._nok, self.overlay = image, scores, nok, None
        self.update()

    def show_map(self, overlay: QImage) -> None:
        """Lay a defect map, an ARGB image, over the strip."""
        self.overlay = overlay
        self.update()

    def show_marks(self, marks: dict[int, str]) -> None:
        """Mark segments, by number from 1, with a word each."""
        self._marks = marks
        self.update()

    def mousePressEvent(self, event: QMouseEvent) -> None:  # noqa: N802 - Qt's name
        """Emit `touched`."""
        self.touched.emit(
            min(SEGMENTS - 1, max(0, int(event.position().x() * SEGMENTS / max(1, self.width()))))
        )

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw strip and cells."""
        colors, painter = theme.colors(), QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        strip = QRectF(0, 0, self.width(), self.height() - LABEL_PX)
        painter.fillRect(strip, QColor(colors.behind_image))
        for layer in (self._image, self.overlay):
            if layer is not None and not layer.isNull():
                painter.drawImage(strip, layer)
        width = self.width() / SEGMENTS
        font = painter.font()
        for index in range(SEGMENTS):
            nok = index < len(self._nok) and self._nok[index]
            cell = QRectF(index * width, strip.height(), width, LABEL_PX)
            painter.fillRect(cell, QColor(colors.bad if nok else colors.surface))
            painter.setPen(QPen(QColor(colors.line), 1))
            painter.drawRect(QRectF(index * width, 0, width, self.height() - 1))
            painter.setPen(QColor(colors.on_bad if nok else colors.text))
            font.setPixelSize(12)
            font.setBold(nok)
            painter.setFont(font)
            score = f"\n{self.scores[index]:.2f}" if index < len(self.scores) else ""
            mark = "✗" if nok else ""
            painter.drawText(cell, Qt.AlignmentFlag.AlignCenter, f"{mark}{index + 1}{score}")
            inside = QRectF(index * width + 2, 2, width - 4, strip.height() - 4)
            if nok:
                painter.setPen(QPen(QColor(RED), 3))
                painter.drawRect(inside)
            if index + 1 in self._marks:
                painter.setPen(QPen(QColor(colors.warn), 3))
                painter.drawRect(inside)
                painter.fillRect(inside, QColor(*SHADE, 150))
                painter.setPen(QColor(YELLOW))
                font.setPixelSize(11)
                painter.setFont(font)
                flags = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
                painter.drawText(inside, flags, self._marks[index + 1])

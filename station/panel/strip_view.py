"""The unwrapped weld with its 21 cells and their scores."""

from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QWidget

from station.domain import SEGMENTS
from station.events import PartEvent, Preview
from station.panel import theme

LABEL_PX = 22


class StripView(QWidget):
    """Strip on top, one score cell a segment below it."""

    def __init__(self) -> None:
        super().__init__()
        self._image: QImage | None = None
        self._shown_id = -1
        self._part: PartEvent | None = None
        self.setMinimumHeight(110)

    def show_part(self, part: PartEvent) -> None:
        """Scores of the last part."""
        self._part = part
        self.update()

    def show_preview(self, preview: Preview) -> None:
        """Strip of the last part."""
        self._image = QImage.fromData(preview.strip_jpeg) if preview.strip_jpeg else None
        self._shown_id = preview.inspection_id
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw strip and cells."""
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.SmoothPixmapTransform)
        painter.fillRect(self.rect(), QColor("#101214"))
        picture = QRectF(0, 0, self.width(), self.height() - LABEL_PX)
        own = self._part is not None and self._part.record.inspection_id == self._shown_id
        if self._image is not None and own:
            painter.drawImage(picture, self._image)
        width = self.width() / SEGMENTS
        scores = self._part.record.inspection.scores if self._part is not None else ()
        for index in range(SEGMENTS):
            nok = self._part is not None and index < len(self._part.seg_nok) and self._part.seg_nok[index]
            cell = QRectF(index * width, picture.height(), width, LABEL_PX)
            painter.fillRect(cell, QColor(theme.BAD if nok else theme.SURFACE))
            painter.setPen(QPen(QColor(theme.LINE), 1))
            painter.drawRect(QRectF(index * width, 0, width, self.height() - 1))
            painter.setPen(QColor("#ffffff" if nok else theme.TEXT))
            text = f"{index + 1}" if index >= len(scores) else f"{index + 1}: {scores[index].nok:.2f}"
            font = painter.font()
            font.setPixelSize(11 if width < 64 else 13)
            font.setBold(nok and width >= 64)
            painter.setFont(font)
            painter.drawText(cell, Qt.AlignmentFlag.AlignCenter, text)
            if nok:
                painter.setPen(QPen(QColor(theme.BAD), 3))
                painter.drawRect(QRectF(index * width + 2, 2, width - 4, picture.height() - 4))

"""The picture of the last part with ring and 21 numbered segments drawn in place."""

from math import cos, radians, sin

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_ROWS
from station.events import PartEvent, Preview
from station.panel import theme


class LiveView(QWidget):
    """Shows one preview; segments in red with a cross where NOK."""

    def __init__(self) -> None:
        super().__init__()
        self._image: QImage | None = None
        self._preview: Preview | None = None
        self._part: PartEvent | None = None
        self.setMinimumSize(420, 380)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_part(self, part: PartEvent) -> None:
        """Keep the part; the overlay is drawn once its own picture is there."""
        self._part = part
        self.update()

    def show_preview(self, preview: Preview) -> None:
        """Show a new picture."""
        self._preview, self._image = preview, QImage.fromData(preview.frame_jpeg)
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw picture and overlay."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor("#101214"))
        if self._image is None or self._image.isNull() or self._preview is None:
            painter.setPen(QColor(theme.QUIET))
            painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "no picture yet")
            return
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        zoom = min(self.width() / self._image.width(), self.height() / self._image.height())
        left = (self.width() - self._image.width() * zoom) / 2
        top = (self.height() - self._image.height() * zoom) / 2
        painter.drawImage(QRectF(left, top, self._image.width() * zoom, self._image.height() * zoom), self._image)
        if self._part is not None and self._part.record.inspection_id == self._preview.inspection_id:
            self._overlay(painter, self._part, self._preview, zoom, QPointF(left, top))
        else:
            self._stale(painter, self._preview.inspection_id)

    def _stale(self, painter: QPainter, inspection_id: int) -> None:
        """The last part has no picture: say that this one is older."""
        painter.fillRect(self.rect(), QColor(16, 18, 20, 150))
        font = painter.font()
        font.setPixelSize(22)
        painter.setFont(font)
        painter.setPen(QColor(theme.TEXT))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, f"no picture of this part\n(behind: part no. {inspection_id})")

    def _overlay(self, painter: QPainter, part: PartEvent, preview: Preview, zoom: float, corner: QPointF) -> None:
        ring = part.record.inspection.ring
        if ring is None:
            return
        k = preview.scale * zoom
        center = corner + QPointF((ring.center_x_px - preview.origin_px[0]) * k, (ring.center_y_px - preview.origin_px[1]) * k)
        half = STRIP_ROWS / 2
        inner, outer = (ring.radius_px - half) * k, (ring.radius_px + half) * k
        painter.setPen(QPen(QColor(230, 232, 234, 110), 1))
        for radius in (inner, outer):
            painter.drawEllipse(center, radius, radius)
        font = painter.font()
        font.setPixelSize(17)
        font.setBold(True)
        painter.setFont(font)
        for index in range(SEGMENTS):
            nok = index < len(part.seg_nok) and part.seg_nok[index]
            start = radians(index * SEGMENT_DEG)
            painter.setPen(QPen(QColor(230, 232, 234, 110), 1))
            painter.drawLine(
                center + QPointF(cos(start) * inner, sin(start) * inner), center + QPointF(cos(start) * outer, sin(start) * outer)
            )
            if nok:
                painter.setPen(QPen(QColor(theme.BAD), 4))
                for radius in (inner, outer):
                    box = QRectF(center.x() - radius, center.y() - radius, 2 * radius, 2 * radius)
                    painter.drawArc(box, int(-(index + 1) * SEGMENT_DEG * 16), int(SEGMENT_DEG * 16))
            middle = radians((index + 0.5) * SEGMENT_DEG)
            at = center + QPointF(cos(middle), sin(middle)) * (outer + 24)
            painter.setPen(QColor(theme.BAD) if nok else QColor(theme.TEXT))
            label = f"✗{index + 1}" if nok else str(index + 1)
            painter.drawText(QRectF(at.x() - 26, at.y() - 13, 52, 26), Qt.AlignmentFlag.AlignCenter, label)

"""A picture of a weld with ring, 21 numbered segments and findings drawn in place."""

from dataclasses import dataclass
from math import cos, pi, radians, sin

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_ROWS, Finding, Ring
from station.panel.look import theme
from station.panel.look.words import data, translate


@dataclass(frozen=True, slots=True)
class Drawn:
    """What is drawn over a picture; `scale` picture pixels per frame pixel, `origin_px` frame pixel of its corner."""

    image: QImage
    scale: float
    origin_px: tuple[int, int]
    ring: Ring | None
    seg_nok: tuple[bool, ...]
    findings: tuple[Finding, ...]


class WeldView(QWidget):
    """Shows one picture, or says why there is none."""

    def __init__(self) -> None:
        super().__init__()
        self.drawn: Drawn | None = None
        self._note, self._caption = "", ""
        self.setMinimumSize(320, 280)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_weld(self, drawn: Drawn | None, note: str = "", caption: str = "") -> None:
        """`note`: stands over the picture, which is darkened; `caption`: in its corner."""
        self.drawn, self._note, self._caption = drawn, note, caption
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw picture and overlay."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.colors().picture))
        d = self.drawn
        if d is None or d.image.isNull():
            self._say(painter, self._note or translate("live", "no picture yet"))
            return
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        zoom = min(self.width() / d.image.width(), self.height() / d.image.height())
        corner = QPointF(
            (self.width() - d.image.width() * zoom) / 2, (self.height() - d.image.height() * zoom) / 2
        )
        painter.drawImage(
            QRectF(corner.x(), corner.y(), d.image.width() * zoom, d.image.height() * zoom), d.image
        )
        if self._note:
            painter.fillRect(self.rect(), QColor(16, 18, 20, 150))
            self._say(painter, self._note)
        elif d.ring is not None:
            k = d.scale * zoom
            center = corner + QPointF(
                (d.ring.center_x_px - d.origin_px[0]) * k, (d.ring.center_y_px - d.origin_px[1]) * k
            )
            _overlay(painter, d, center, d.ring.radius_px * k, STRIP_ROWS / 2 * k)
        if self._caption and not self._note:
            font = painter.font()
            font.setPixelSize(15)
            font.setBold(False)
            painter.setFont(font)
            box = painter.boundingRect(QRectF(10, 8, self.width() - 20, 60), 0, self._caption)
            painter.fillRect(box.adjusted(-4, -2, 4, 2), QColor(16, 18, 20, 170))
            painter.setPen(QColor("#e6e8ea"))
            painter.drawText(box, 0, self._caption)

    def _say(self, painter: QPainter, text: str) -> None:
        font = painter.font()
        font.setPixelSize(22)
        painter.setFont(font)
        painter.setPen(QColor("#e6e8ea"))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, text)


def _overlay(painter: QPainter, d: Drawn, center: QPointF, radius: float, half: float) -> None:
    inner, outer = radius - half, radius + half
    faint, red = QPen(QColor(230, 232, 234, 110), 1), QColor("#ff5a4f")
    painter.setPen(faint)
    for r in (inner, outer):
        painter.drawEllipse(center, r, r)
    font = painter.font()
    font.setPixelSize(17)
    font.setBold(True)
    painter.setFont(font)
    for index in range(SEGMENTS):
        nok = index < len(d.seg_nok) and d.seg_nok[index]
        painter.setPen(faint)
        painter.drawLine(_at(center, inner, index * SEGMENT_DEG), _at(center, outer, index * SEGMENT_DEG))
        if nok:
            painter.setPen(QPen(red, 3))
            for r in (inner, outer):
                _arc(painter, center, r, index * SEGMENT_DEG, (index + 1) * SEGMENT_DEG)
        at = _at(center, inner - 20, (index + 0.5) * SEGMENT_DEG)
        painter.setPen(red if nok else QColor("#e6e8ea"))
        painter.drawText(
            QRectF(at.x() - 26, at.y() - 13, 52, 26),
            Qt.AlignmentFlag.AlignCenter,
            f"✗{index + 1}" if nok else str(index + 1),
        )
    font.setPixelSize(14)
    painter.setFont(font)
    for finding in d.findings:
        painter.setPen(QPen(QColor("#ffcf4a"), 5))
        _arc(painter, center, outer + 7, finding.start_deg, finding.end_deg)
        at = _at(center, outer + 34, (finding.start_deg + finding.end_deg) / 2)
        text = f"{data(finding.kind)}\n{finding.length_mm:.2f} mm"
        room = painter.viewport()  # a label is moved rather than cut
        x, y = min(max(at.x(), 50), room.width() - 50), min(max(at.y(), 18), room.height() - 18)
        box = QRectF(x - 55, y - 18, 110, 36)
        painter.fillRect(
            painter.boundingRect(box, int(Qt.AlignmentFlag.AlignCenter), text), QColor(16, 18, 20, 170)
        )
        painter.setPen(QColor("#ffcf4a"))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)


def _at(center: QPointF, radius: float, angle_deg: float) -> QPointF:
    return center + QPointF(cos(radians(angle_deg)), sin(radians(angle_deg))) * radius


def _arc(painter: QPainter, center: QPointF, radius: float, start_deg: float, end_deg: float) -> None:
    """Clockwise, and never so short that it cannot be seen."""
    span = max(end_deg - start_deg, 6 / radius * 180 / pi)
    box = QRectF(center.x() - radius, center.y() - radius, 2 * radius, 2 * radius)
    painter.drawArc(box, int(-start_deg * 16), int(-span * 16))

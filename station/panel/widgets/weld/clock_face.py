"""A clock face of 21 segments that shows how often each was rejected.

It points at the welding process: start and overlap, focus, gap.
"""

from math import cos, pi, sin

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QPainter, QPainterPath, QPaintEvent
from PySide6.QtWidgets import QWidget

from station.domain import SEGMENT_DEG, SEGMENTS
from station.panel.look import theme


class ClockFace(QWidget):
    """Shows sectors as long as their counts; angle 0 is at the right, clockwise as in the image."""

    def __init__(self) -> None:
        super().__init__()
        self.counts: tuple[int, ...] = (0,) * SEGMENTS
        self.setMinimumSize(170, 170)

    def show_counts(self, counts: tuple[int, ...]) -> None:
        """Show one count for each segment."""
        if counts != self.counts:
            self.counts = counts
            self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw the face."""
        colors, painter = theme.colors(), QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        center, full = QPointF(self.width() / 2, self.height() / 2), min(self.width(), self.height()) / 2 - 4
        base, room, most = full * 0.56, full * 0.30, max(1, *self.counts)
        font = painter.font()
        painter.setPen(Qt.PenStyle.NoPen)
        for index, count in enumerate(self.counts):
            start = index * SEGMENT_DEG
            painter.fillPath(_sector(center, base * 0.9, base * 0.97, start), QColor(colors.line))
            if count:
                painter.fillPath(_sector(center, base, base + room * count / most, start), QColor(colors.bad))
        for index, count in enumerate(self.counts):
            angle = (index + 0.5) * SEGMENT_DEG * pi / 180
            for text, radius, color, size in (
                (str(index + 1), base * 0.76, colors.quiet, full * 0.1),
                (
                    str(count) if count else "",
                    base + room * count / most + full * 0.09,
                    colors.bad_text,
                    full * 0.11,
                ),
            ):
                font.setPixelSize(max(9, int(size)))
                painter.setFont(font)
                painter.setPen(QColor(color))
                at = center + QPointF(cos(angle), sin(angle)) * radius
                painter.drawText(QRectF(at.x() - 20, at.y() - 10, 40, 20), Qt.AlignmentFlag.AlignCenter, text)
        total = sum(self.counts)
        font.setPixelSize(max(12, int(full * 0.22)))
        font.setBold(True)
        painter.setFont(font)
        painter.setPen(QColor(colors.bad_text if total else colors.quiet))
        painter.drawText(
            QRectF(center.x() - base, center.y() - base, 2 * base, 2 * base),
            Qt.AlignmentFlag.AlignCenter,
            str(total),
        )


def _sector(center: QPointF, inner: float, outer: float, start_deg: float) -> QPainterPath:
    path, first, span = QPainterPath(), start_deg + SEGMENT_DEG * 0.06, SEGMENT_DEG * 0.88
    boxes = [
        QRectF(center.x() - radius, center.y() - radius, 2 * radius, 2 * radius) for radius in (outer, inner)
    ]
    path.arcMoveTo(boxes[0], -first)
    path.arcTo(boxes[0], -first, -span)
    path.arcTo(boxes[1], -first - span, span)
    path.closeSubpath()
    return path

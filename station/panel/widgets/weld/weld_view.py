"""An image of a weld with ring, 21 numbered segments and findings drawn over it."""

from dataclasses import dataclass
from math import cos, pi, radians, sin

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from station.domain import SEGMENT_DEG, SEGMENTS, STRIP_ROWS, Finding, Ring
from station.panel.look import theme
from station.panel.look.words import data, translate
from station.vision.unwrap import row_px

SHADE = (16, 18, 20)
LIGHT, RED, YELLOW = "#e6e8ea", "#ff5a4f", "#ffcf4a"
"""Colours over images, which are dark in both themes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawn:
    """An image and what is drawn over it."""

    image: QImage
    scale: float
    """Image pixels per frame pixel."""
    origin_px: tuple[int, int]
    """Frame pixel (x, y) of the image's corner."""
    um_per_px: float
    """Scale of the frame."""
    ring: Ring | None = None
    segments_nok: tuple[bool, ...] = ()
    """True for each rejected segment."""
    segments_invalid: tuple[bool, ...] = ()
    """True for each segment that was not seen and is not rejected."""
    findings: tuple[Finding, ...] = ()


class WeldView(QWidget):
    """Shows one image, or a note why there is none."""

    def __init__(self) -> None:
        super().__init__()
        self.drawn: Drawn | None = None
        self.note, self._caption = "", ""
        self.setMinimumSize(320, 280)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)

    def show_weld(self, drawn: Drawn | None, note: str = "", caption: str = "") -> None:
        """Show an image; `note` is written over it and darkens it, `caption` is shown in its corner."""
        self.drawn, self.note, self._caption = drawn, note, caption
        self.update()

    def paintEvent(self, _event: QPaintEvent) -> None:  # noqa: N802 - Qt's name
        """Draw image and overlay."""
        painter = QPainter(self)
        painter.fillRect(self.rect(), QColor(theme.colors().behind_image))
        drawn = self.drawn
        if drawn is None or drawn.image.isNull():
            self._write(painter, self.note or translate("live", "no image yet"))
            return
        painter.setRenderHints(QPainter.RenderHint.Antialiasing | QPainter.RenderHint.SmoothPixmapTransform)
        zoom = min(self.width() / drawn.image.width(), self.height() / drawn.image.height())
        corner = QPointF(
            (self.width() - drawn.image.width() * zoom) / 2, (self.height() - drawn.image.height() * zoom) / 2
        )
        painter.drawImage(
            QRectF(corner.x(), corner.y(), drawn.image.width() * zoom, drawn.image.height() * zoom),
            drawn.image,
        )
        if self.note:
            painter.fillRect(self.rect(), QColor(*SHADE, 150))
            self._write(painter, self.note)
        elif drawn.ring is not None:
            scale = drawn.scale * zoom
            x_px, y_px = drawn.origin_px
            center = QPointF(drawn.ring.center_x_px - x_px, drawn.ring.center_y_px - y_px) * scale
            half = STRIP_ROWS / 2 * row_px(drawn.um_per_px) * scale
            overlay = _Overlay(painter, corner + center, drawn.ring.radius_px * scale, half)
            overlay.draw(drawn)
        if self._caption and not self.note:
            font = painter.font()
            font.setPixelSize(15)
            font.setBold(False)
            painter.setFont(font)
            box = painter.boundingRect(QRectF(10, 8, self.width() - 20, 60), 0, self._caption)
            painter.fillRect(box.adjusted(-4, -2, 4, 2), QColor(*SHADE, 170))
            painter.setPen(QColor(LIGHT))
            painter.drawText(box, 0, self._caption)

    def _write(self, painter: QPainter, text: str) -> None:
        font = painter.font()
        font.setPixelSize(22)
        painter.setFont(font)
        painter.setPen(QColor(LIGHT))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap, text)


@dataclass(frozen=True, slots=True)
class _Overlay:
    """Draws ring, segments and findings around a center; lengths in pixels of the widget."""

    painter: QPainter
    center: QPointF
    radius: float
    half: float
    """Half of the strip's width."""

    def draw(self, drawn: Drawn) -> None:
        inner, outer = self.radius - self.half, self.radius + self.half
        faint = QPen(QColor(230, 232, 234, 110), 1)
        self.painter.setPen(faint)
        for radius in (inner, outer):
            self.painter.drawEllipse(self.center, radius, radius)
        self._set_font(17, bold=True)
        for index in range(SEGMENTS):
            nok = index < len(drawn.segments_nok) and drawn.segments_nok[index]
            unseen = index < len(drawn.segments_invalid) and drawn.segments_invalid[index]
            start_deg, color = index * SEGMENT_DEG, RED if nok else YELLOW if unseen else LIGHT
            self.painter.setPen(faint)
            self.painter.drawLine(self._at(inner, start_deg), self._at(outer, start_deg))
            if nok or unseen:
                self.painter.setPen(
                    QPen(QColor(color), 3, Qt.PenStyle.SolidLine if nok else Qt.PenStyle.DotLine)
                )
                for radius in (inner, outer):
                    self._arc(radius, start_deg, start_deg + SEGMENT_DEG)
            at = self._at(inner - 20, start_deg + SEGMENT_DEG / 2)
            self.painter.setPen(QColor(color))
            self.painter.drawText(
                QRectF(at.x() - 26, at.y() - 13, 52, 26),
                Qt.AlignmentFlag.AlignCenter,
                f"{'✗' if nok else '?' if unseen else ''}{index + 1}",
            )
        self._set_font(14, bold=True)
        for finding in drawn.findings:
            self._draw_finding(finding, outer)

    def _draw_finding(self, finding: Finding, outer: float) -> None:
        self.painter.setPen(QPen(QColor(YELLOW), 5))
        self._arc(outer + 7, finding.start_deg, finding.end_deg)
        at = self._at(outer + 34, (finding.start_deg + finding.end_deg) / 2)
        text = f"{data(finding.kind)}\n{finding.length_mm:.2f} mm"
        room = self.painter.viewport()  # a label is moved rather than cut off
        x, y = min(max(at.x(), 50), room.width() - 50), min(max(at.y(), 18), room.height() - 18)
        box = QRectF(x - 55, y - 18, 110, 36)
        covered = self.painter.boundingRect(box, int(Qt.AlignmentFlag.AlignCenter), text)
        self.painter.fillRect(covered, QColor(*SHADE, 170))
        self.painter.setPen(QColor(YELLOW))
        self.painter.drawText(box, Qt.AlignmentFlag.AlignCenter, text)

    def _set_font(self, size_px: int, *, bold: bool) -> None:
        font = self.painter.font()
        font.setPixelSize(size_px)
        font.setBold(bold)
        self.painter.setFont(font)

    def _at(self, radius: float, angle_deg: float) -> QPointF:
        return self.center + QPointF(cos(radians(angle_deg)), sin(radians(angle_deg))) * radius

    def _arc(self, radius: float, start_deg: float, end_deg: float) -> None:
        """Draw an arc clockwise, at least as long as it takes to be seen."""
        span_deg = max(end_deg - start_deg, 6 / radius * 180 / pi)
        box = QRectF(self.center.x() - radius, self.center.y() - radius, 2 * radius, 2 * radius)
        self.painter.drawArc(box, int(-start_deg * 16), int(-span_deg * 16))

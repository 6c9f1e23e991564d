"""The strip with its 21 segments, their scores and what was not seen; the defect map can be laid over it."""

from PySide6.QtCore import QEvent, QRectF, Qt, Signal
from PySide6.QtGui import QBrush, QColor, QHelpEvent, QImage, QMouseEvent, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QToolTip, QWidget

from station.domain import SEGMENTS, Inspection
from station.panel.look import theme
from station.panel.look.words import data
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
        self._inspection: Inspection | None = None
        self._marks: dict[int, str] = {}
        self.setMinimumHeight(height_px)

    def show_strip(self, image: QImage | None, inspection: Inspection | None) -> None:
        """Show a strip, or none, with what is known of each segment."""
        self._image, self._inspection, self.overlay = image, inspection, None
        self.update()

    @property
    def scores(self) -> tuple[float | None, ...]:
        """Scores of NOK that are shown, None for a segment that was not seen."""
        return () if self._inspection is None else self._inspection.nok_scores

    @property
    def causes(self) -> dict[int, str]:
        """Why segments were not seen, by number from 1, as it is shown; a rejected segment counts as seen."""
        found = self._inspection
        if found is None:
            return {}
        pairs = enumerate(zip(found.unseen, found.invalid, strict=True), start=1)
        return {number: data(cause) for number, (cause, invalid) in pairs if invalid}

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
        self.touched.emit(self._at(event.position().x()))

    def event(self, event: QEvent) -> bool:
        """Show as a tool tip why the segment under the pointer was not seen."""
        if isinstance(event, QHelpEvent) and event.type() is QEvent.Type.ToolTip:
            cause = self.causes.get(self._at(event.pos().x()) + 1, "")
            QToolTip.showText(event.globalPos(), cause, self)
            return True
        return super().event(event)

    def _at(self, x_px: float) -> int:
        """Return the index of the segment at a position in the widget."""
        return min(SEGMENTS - 1, max(0, int(x_px * SEGMENTS / max(1, self.width()))))

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
        scores, causes = self.scores, self.causes
        rejected = () if self._inspection is None else self._inspection.nok
        for index in range(SEGMENTS):
            nok, cause = index < len(rejected) and rejected[index], causes.get(index + 1)
            cell = QRectF(index * width, strip.height(), width, LABEL_PX)
            painter.fillRect(cell, QColor(colors.bad if nok else colors.warn if cause else colors.surface))
            painter.setPen(QPen(QColor(colors.line), 1))
            painter.drawRect(QRectF(index * width, 0, width, self.height() - 1))
            painter.setPen(QColor(colors.on_bad if nok else colors.on_color if cause else colors.text))
            font.setPixelSize(12)
            font.setBold(nok or cause is not None)
            painter.setFont(font)
            known = scores[index] if index < len(scores) else None
            below = "" if known is None else f"\n{known:.2f}"
            mark = "✗" if nok else "?" if cause else ""
            painter.drawText(cell, Qt.AlignmentFlag.AlignCenter, f"{mark}{index + 1}{below}")
            inside = QRectF(index * width + 2, 2, width - 4, strip.height() - 4)
            if nok:
                painter.setPen(QPen(QColor(RED), 3))
                painter.drawRect(inside)
            if cause is not None:
                painter.fillRect(inside, QBrush(QColor(YELLOW), Qt.BrushStyle.BDiagPattern))
            words = self._marks.get(index + 1) or cause
            if words is not None:
                painter.setPen(QPen(QColor(colors.warn), 3))
                painter.drawRect(inside)
                painter.fillRect(inside, QColor(*SHADE, 150))
                painter.setPen(QColor(YELLOW))
                font.setPixelSize(11)
                painter.setFont(font)
                flags = int(Qt.AlignmentFlag.AlignCenter | Qt.TextFlag.TextWordWrap)
                painter.drawText(inside, flags, words)

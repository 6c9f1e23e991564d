"""A list of parts: picture in small, symbol, number, serial, time. The symbol says the verdict, its colour too."""

from collections.abc import Mapping, Sequence
from datetime import datetime

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QImage, QPainter, QPixmap
from PySide6.QtWidgets import QAbstractItemView, QListView, QListWidget, QListWidgetItem

from station.archive.reader import Row
from station.journal.reviews import Review, State
from station.panel.look import theme
from station.panel.look.words import data
from station.panel.widgets.card import by_finger

SYMBOLS = {"OK": "✓", "NOK": "✗", "ERROR": "!"}
REVIEWED = {State.NONE: "", State.ONE: " ◔", State.AGREED: " ●", State.DISPUTED: " ?"}
ICON_PX = 72


class Filmstrip(QListWidget):
    """One item a part; the row is kept in it."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: dict[int, Row] = {}
        self.setIconSize(QSize(ICON_PX, ICON_PX))
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setUniformItemSizes(True)
        by_finger(self)
        self.as_gallery(False)

    def as_gallery(self, gallery: bool) -> None:
        """Pictures side by side, or a list with words."""
        self.setViewMode(QListView.ViewMode.IconMode if gallery else QListView.ViewMode.ListMode)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setMovement(QListView.Movement.Static)
        self.setGridSize(QSize(118, 118) if gallery else QSize())
        self.setWordWrap(gallery)

    def fill(self, rows: Sequence[Row], thumbs: Mapping[int, QImage], reviews: Mapping[int, Review]) -> None:
        """Parts in this order; the chosen one stays chosen if it is there."""
        chosen = self.chosen()
        self.blockSignals(True)
        self.clear()
        self.rows = {row.inspection_id: row for row in rows}
        for row in rows:
            review = reviews.get(row.inspection_id)
            mark = REVIEWED[review.state] if review else ""
            when = datetime.fromisoformat(row.grabbed_at).astimezone()
            reason = data(row.reason) if row.reason else ""
            purpose = "" if row.purpose == "part" else f" · {data(row.purpose)}"
            text = f"{row.inspection_id}{mark}  {row.serial}\n{when:%d.%m. %H:%M:%S}{purpose}\n{reason}"
            picture, icon = tile(row.verdict, thumbs.get(row.inspection_id)), QIcon()
            for mode in (QIcon.Mode.Normal, QIcon.Mode.Selected):
                icon.addPixmap(picture, mode)
            item = QListWidgetItem(icon, text)
            item.setData(Qt.ItemDataRole.UserRole, row.inspection_id)
            self.addItem(item)
            if chosen == row.inspection_id:
                self.setCurrentItem(item)
        self.blockSignals(False)

    def chosen(self) -> int | None:
        """Number of the chosen part."""
        item = self.currentItem()
        return None if item is None else int(item.data(Qt.ItemDataRole.UserRole))


def tile(verdict: str, thumb: QImage | None) -> QPixmap:
    """Picture with the verdict's symbol in its corner; a plain tile if there is no picture. Green is for a fresh OK alone."""
    c = theme.colors()
    color, on = {"OK": (c.raised, c.text), "NOK": (c.bad, c.on_bad)}.get(verdict, (c.warn, c.on_color))
    pixmap = QPixmap(ICON_PX, ICON_PX)
    pixmap.fill(QColor(c.picture))
    painter = QPainter(pixmap)
    corner = QRectF(ICON_PX - 26, ICON_PX - 26, 26, 26)
    if thumb is not None and not thumb.isNull():
        painter.drawImage(QRectF(0, 0, ICON_PX, ICON_PX), thumb)
    else:
        corner = QRectF(16, 16, ICON_PX - 32, ICON_PX - 32)
    painter.fillRect(corner, QColor(color))
    font = painter.font()
    font.setPixelSize(int(corner.height() * 0.75))
    font.setBold(True)
    painter.setFont(font)
    painter.setPen(QColor(on))
    painter.drawText(corner, Qt.AlignmentFlag.AlignCenter, SYMBOLS.get(verdict, "?"))
    painter.end()
    return pixmap

"""A list of parts with thumbnail, verdict (as symbol and colour), number, serial and time."""

from collections.abc import Mapping, Sequence
from datetime import datetime

from PySide6.QtCore import QRectF, QSize, Qt
from PySide6.QtGui import QColor, QIcon, QImage, QPainter, QPixmap
from PySide6.QtWidgets import QAbstractItemView, QListView, QListWidget, QListWidgetItem

from station.archive.reader import Row
from station.domain import Purpose
from station.journal.reviews import Review, State
from station.panel.look import theme
from station.panel.look.purposes import PURPOSE_WORDS
from station.panel.look.words import data
from station.panel.widgets.card import by_finger

SYMBOLS = {"OK": "✓", "NOK": "✗", "ERROR": "!"}
REVIEWED = {State.NONE: "", State.ONE: " ◔", State.AGREED: " ●", State.DISPUTED: " ?"}
ICON_PX = 72


class Filmstrip(QListWidget):
    """Shows one item for each part, as a list or as a gallery."""

    def __init__(self) -> None:
        super().__init__()
        self.rows: dict[int, Row] = {}
        """Rows of the index by number of the part, in the order of the list."""
        self.setIconSize(QSize(ICON_PX, ICON_PX))
        self.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self.setUniformItemSizes(True)
        by_finger(self)
        self.as_gallery(False)

    def as_gallery(self, gallery: bool) -> None:
        """Show images side by side, or a list with texts."""
        self.setViewMode(QListView.ViewMode.IconMode if gallery else QListView.ViewMode.ListMode)
        self.setResizeMode(QListView.ResizeMode.Adjust)
        self.setMovement(QListView.Movement.Static)
        self.setGridSize(QSize(118, 118) if gallery else QSize())
        self.setWordWrap(gallery)

    def fill(self, rows: Sequence[Row], thumbs: Mapping[int, QImage], reviews: Mapping[int, Review]) -> None:
        """Show parts in this order; the chosen one stays chosen if it is among them."""
        chosen = self.chosen()
        self.blockSignals(True)
        self.clear()
        self.rows = {row.inspection_id: row for row in rows}
        for row in rows:
            review = reviews.get(row.inspection_id)
            mark = REVIEWED[review.state] if review else ""
            when = datetime.fromisoformat(row.grabbed_at).astimezone()
            reason = data(row.reason) if row.reason else ""
            is_part = row.purpose == Purpose.PART
            purpose = "" if is_part else f" · {data(PURPOSE_WORDS.get(row.purpose, row.purpose))}"
            text = f"{row.inspection_id}{mark}  {row.serial}\n{when:%d.%m. %H:%M:%S}{purpose}\n{reason}"
            pixmap, icon = tile(row.verdict, thumbs.get(row.inspection_id)), QIcon()
            for mode in (QIcon.Mode.Normal, QIcon.Mode.Selected):
                icon.addPixmap(pixmap, mode)
            item = QListWidgetItem(icon, text)
            item.setData(Qt.ItemDataRole.UserRole, row.inspection_id)
            self.addItem(item)
            if chosen == row.inspection_id:
                self.setCurrentItem(item)
        self.blockSignals(False)

    def chosen(self) -> int | None:
        """Return the number of the chosen part, or None."""
        item = self.currentItem()
        return None if item is None else int(item.data(Qt.ItemDataRole.UserRole))


def tile(verdict: str, thumb: QImage | None) -> QPixmap:
    """Return a thumbnail with the verdict's symbol in its corner, or a plain tile if there is no image.

    OK is not green here: green means a fresh OK.
    """
    colors = theme.colors()
    known = {"OK": (colors.raised, colors.text), "NOK": (colors.bad, colors.on_bad)}
    color, text_color = known.get(verdict, (colors.warn, colors.on_color))
    pixmap = QPixmap(ICON_PX, ICON_PX)
    pixmap.fill(QColor(colors.behind_image))
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
    painter.setPen(QColor(text_color))
    painter.drawText(corner, Qt.AlignmentFlag.AlignCenter, SYMBOLS.get(verdict, "?"))
    painter.end()
    return pixmap

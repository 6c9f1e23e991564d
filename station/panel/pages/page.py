"""What all pages of the window have in common."""

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QWidget


class Page(QWidget):
    """A page; made from the session, and made again whenever language or theme change."""

    def open_part(self, number: int) -> None:
        """Show this part, on a page that shows parts of the archive."""

    def close_page(self) -> None:
        """Stop timers and work; the page is not used afterwards."""


class FollowingPage(Page):
    """A page that reads what it shows again and again while it is visible."""

    def __init__(self) -> None:
        super().__init__()
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._on_time)

    def follow(self, interval_ms: int) -> None:
        """Refresh now, and at this interval from then on; called once all widgets of the page are made."""
        self._timer.start(interval_ms)
        self.refresh()

    def refresh(self) -> None:
        """Read again what the page shows."""
        raise NotImplementedError

    def close_page(self) -> None:
        """Stop refreshing."""
        self._timer.stop()

    def _on_time(self) -> None:
        if self.isVisible():
            self.refresh()

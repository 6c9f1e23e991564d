"""What all pages of the window have in common."""

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QWidget


class Page(QWidget):
    """A page, built from the session; it is built again whenever language or theme change."""

    def open_part(self, number: int) -> None:
        """Show this part, if the page shows recorded parts."""

    def close_page(self) -> None:
        """Stop timers and work; the page is not used afterwards."""


class FollowingPage(Page):
    """A page that reads again what it shows at regular intervals while it is visible."""

    def __init__(self) -> None:
        super().__init__()
        self.timer = QTimer(self)
        self.timer.timeout.connect(self._on_time)

    def follow(self, interval_ms: int) -> None:
        """Refresh now and then at this interval; to be called once all widgets of the page are built."""
        self.timer.start(interval_ms)
        self.refresh()

    def refresh(self) -> None:
        """Read again what the page shows."""
        raise NotImplementedError

    def close_page(self) -> None:
        """Stop refreshing."""
        self.timer.stop()

    def _on_time(self) -> None:
        if self.isVisible():
            self.refresh()

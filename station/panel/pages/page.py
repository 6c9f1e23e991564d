"""What all pages of the window have in common."""

from PySide6.QtWidgets import QWidget


class Page(QWidget):
    """A page; made from the session, and made again whenever language or theme change."""

    def open_part(self, number: int) -> None:
        """Show this part, on a page that shows parts of the archive."""

    def close_page(self) -> None:
        """Stop timers and work; the page is not used afterwards."""

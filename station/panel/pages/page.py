"""What a page of the window is."""

from PySide6.QtWidgets import QWidget


class Page(QWidget):
    """Made from the session, and made anew whenever language or theme change."""

    def close_page(self) -> None:
        """Nothing is left running."""

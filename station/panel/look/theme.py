"""Colours, fonts and sizes of the dark and the light theme; holds the only style sheet.

Everything is grey; colour is used only for what is abnormal or fresh.
"""

from dataclasses import dataclass

from PySide6.QtWidgets import QApplication


@dataclass(frozen=True, slots=True, kw_only=True)
class Colors:
    """Colours of one theme, as #rrggbb.

    Text on `background` and on `surface` has a contrast of at least 4.5:1 (WCAG 2.1, 1.4.3); tested.
    """

    background: str
    surface: str
    raised: str
    behind_image: str
    text: str
    quiet: str
    line: str
    good: str
    bad: str
    warn: str
    test: str
    on_color: str
    """Text on `good`, `warn` and `test`."""
    on_bad: str
    """Text on `bad`."""
    bad_text: str
    """Red as text."""
    warn_text: str
    """Yellow as text."""
    accent: str
    """Marks what is chosen."""


DARK = Colors(
    background="#1e2124",
    surface="#2a2e32",
    raised="#363b40",
    behind_image="#101214",
    text="#e6e8ea",
    quiet="#a9b0b7",
    line="#454b52",
    good="#2fa862",
    bad="#c9382f",
    warn="#e0a92e",
    test="#5b9ade",
    on_color="#101214",
    on_bad="#ffffff",
    bad_text="#ff8a80",
    warn_text="#e8b84a",
    accent="#8fa3b5",
)
LIGHT = Colors(
    background="#eef0f2",
    surface="#ffffff",
    raised="#e1e5e8",
    behind_image="#202428",
    text="#1d2125",
    quiet="#565e66",
    line="#c3c9cf",
    good="#3bb573",
    bad="#c9382f",
    warn="#e8b13a",
    test="#6aa6e6",
    on_color="#101214",
    on_bad="#ffffff",
    bad_text="#b3261e",
    warn_text="#7a5200",
    accent="#4a6076",
)
THEMES = {"dark": DARK, "light": LIGHT}
"""Colours of each theme by its name in the settings."""
_used = ["dark"]


def colors() -> Colors:
    """Return the colours of the theme in use."""
    return THEMES[_used[0]]


def name() -> str:
    """Return the name of the theme in use."""
    return _used[0]


def use(theme: str) -> None:
    """Use this theme in the whole application."""
    _used[0] = theme
    app = QApplication.instance()
    if isinstance(app, QApplication):
        sheet = style(THEMES[theme])
        if app.styleSheet() != sheet:  # setting it styles every widget again
            app.setStyle("Fusion")  # looks the same on every machine
            app.setStyleSheet(sheet)


def style(c: Colors) -> str:
    """Return the style sheet of a theme. Touch targets are at least 44 px high."""
    return f"""
QWidget {{
    background: {c.background}; color: {c.text};
    font-family: "DejaVu Sans", "Segoe UI", sans-serif; font-size: 15px; }}
QFrame#card, QFrame#header, QFrame#nav {{
    background: {c.surface}; border: 1px solid {c.line}; border-radius: 6px; }}
QFrame#header, QFrame#nav {{ border: none; border-radius: 0; }}
QFrame#card QLabel, QFrame#header QLabel {{ background: transparent; }}
QLabel#quiet {{ color: {c.quiet}; font-size: 13px; }}
QLabel#title {{ font-size: 18px; font-weight: 600; }}
QLabel#value {{ font-size: 22px; font-weight: 600; }}
QLabel#problem {{ color: {c.bad_text}; font-weight: 600; }}
QFrame#header QLabel#badge {{
    background: {c.test}; color: {c.on_color}; font-weight: 700; padding: 4px 10px; border-radius: 4px; }}
QPushButton {{
    background: {c.surface}; border: 1px solid {c.line}; border-radius: 6px; padding: 8px 14px;
    min-height: 28px; }}
QPushButton:pressed, QPushButton:checked {{ background: {c.raised}; border: 2px solid {c.accent}; }}
QPushButton:focus {{ border: 2px solid {c.accent}; }}
QPushButton:disabled {{ color: {c.quiet}; background: {c.background}; }}
QPushButton#nav {{
    border: none; border-radius: 0; text-align: left; padding: 10px 14px; font-size: 16px;
    min-height: 40px; }}
QPushButton#nav:checked {{ background: {c.background}; border-left: 5px solid {c.accent}; font-weight: 700; }}
QPushButton#flat {{ border: none; background: transparent; padding: 6px 10px; }}
QPushButton#nav:focus, QPushButton#flat:focus {{ border: 2px solid {c.accent}; }}
QPushButton#key {{ font-size: 18px; padding: 4px; min-width: 20px; min-height: 36px; }}
QLineEdit, QComboBox, QDateTimeEdit {{
    background: {c.surface}; border: 1px solid {c.line}; border-radius: 4px; padding: 6px;
    min-height: 30px; }}
QLineEdit:focus, QComboBox:focus, QDateTimeEdit:focus {{ border: 2px solid {c.accent}; }}
QLineEdit:disabled, QComboBox:disabled {{ color: {c.quiet}; background: {c.background}; }}
QComboBox::drop-down {{ border: none; width: 24px; }}
QComboBox::down-arrow {{
    width: 0; height: 0; border-left: 5px solid {c.surface}; border-right: 5px solid {c.surface};
    border-top: 7px solid {c.quiet}; margin-right: 8px; }}
QComboBox QAbstractItemView::item {{ min-height: 44px; }}
QComboBox QAbstractItemView {{
    background: {c.surface}; selection-background-color: {c.raised}; selection-color: {c.text}; }}
QTableView, QListView {{
    background: {c.surface}; alternate-background-color: {c.background}; border: 1px solid {c.line};
    gridline-color: {c.line}; selection-background-color: {c.raised}; selection-color: {c.text}; }}
QHeaderView::section {{
    background: {c.raised}; color: {c.text}; border: none; border-right: 1px solid {c.line}; padding: 6px; }}
QTabBar::tab {{ background: {c.surface}; border: 1px solid {c.line}; padding: 10px 18px; min-height: 24px; }}
QTabBar::tab:selected {{ background: {c.raised}; border-bottom: 3px solid {c.accent}; font-weight: 700; }}
QTabWidget::pane {{ border: none; }}
QProgressBar {{
    background: {c.surface}; border: 1px solid {c.line}; border-radius: 4px; text-align: center;
    min-height: 24px; }}
QProgressBar::chunk {{ background: {c.accent}; }}
QScrollArea {{ border: none; }}
QWidget#plain {{ background: transparent; }}
QScrollBar:vertical {{ background: {c.background}; width: 22px; margin: 0; }}
QScrollBar:horizontal {{ background: {c.background}; height: 22px; margin: 0; }}
QScrollBar::handle {{
    background: {c.line}; border-radius: 6px; margin: 2px; min-height: 44px; min-width: 44px; }}
QScrollBar::add-line, QScrollBar::sub-line {{ width: 0; height: 0; }}
QScrollBar::add-page, QScrollBar::sub-page {{ background: transparent; }}
QToolTip {{ background: {c.raised}; color: {c.text}; border: 1px solid {c.line}; padding: 4px; }}
"""

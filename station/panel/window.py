"""The operator's window: a header, a button for each page, and the page that is shown.

A page is built when it is first shown, so that the window opens fast. When language or theme change,
all widgets are built again from the session.
"""

from collections.abc import Callable

from PySide6.QtCore import QEvent, QObject, Qt, QTimer
from PySide6.QtGui import QCloseEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QApplication,
    QButtonGroup,
    QFrame,
    QHBoxLayout,
    QMainWindow,
    QPushButton,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from station.domain import Origin
from station.panel.look import theme, words
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.pages.table import PAGES, PageInfo, PageKey
from station.panel.session.session import Session
from station.panel.widgets.card import label, scrolled
from station.panel.widgets.keys import Keys
from station.plc.map.alarms import TEXTS

AGE_MS = 500
"""Interval at which the header is shown again, as the connection may be lost."""
NAV_PX, HEADER_PX = 170, 56


class Window(QMainWindow):
    """Shows one page at a time; everything it shows comes from the session."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.setWindowTitle("weldgate")
        self.setMinimumSize(1180, 720)
        self.resize(1280, 800)
        self._pages: dict[PageKey, Page] = {}
        """Pages that have been built."""
        self._build(PAGES[0].key)
        session.received.status_changed.connect(self._on_status)
        session.account.changed.connect(self._on_user)
        session.part_chosen.connect(self._open_part)
        self._ageing = QTimer(self)
        self._ageing.timeout.connect(self._on_status)
        self._ageing.start(AGE_MS)
        for number, info in enumerate(PAGES, 1):
            QShortcut(QKeySequence(f"F{number}"), self, lambda key=info.key: self.go(key))

    def _build(self, chosen: PageKey) -> None:
        """Build all widgets in the language and theme in use, and show a page."""
        self._stack, nav = QStackedWidget(), QFrame()
        nav.setObjectName("nav")
        nav.setFixedWidth(NAV_PX)
        column = QVBoxLayout(nav)
        column.setContentsMargins(0, 6, 0, 6)
        column.setSpacing(0)
        self.buttons, self._places = dict[PageKey, QPushButton](), dict[PageKey, QStackedWidget]()
        group = QButtonGroup(nav)
        for number, info in enumerate(PAGES, 1):
            button, place = self._button(info, number), QStackedWidget()
            group.addButton(button)
            column.addWidget(button)
            self._stack.addWidget(place)
            self.buttons[info.key], self._places[info.key] = button, place
        column.addStretch(1)
        body = QWidget()
        rows = QVBoxLayout(body)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.setSpacing(0)
        rows.addWidget(self._header())
        middle = QHBoxLayout()
        middle.setSpacing(0)
        middle.addWidget(nav)
        middle.addWidget(self._stack, 1)
        rows.addLayout(middle, 1)
        self._foot = QVBoxLayout()
        rows.addLayout(self._foot)
        self.setCentralWidget(body)
        self.go(chosen)
        self._on_user()
        self._on_status()

    def _button(self, info: PageInfo, number: int) -> QPushButton:
        button = QPushButton(info.title())
        button.setObjectName("nav")
        button.setCheckable(True)
        button.setToolTip(f"F{number}")
        button.clicked.connect(lambda: self.go(info.key))
        return button

    def _header(self) -> QFrame:
        header = QFrame()
        header.setObjectName("header")
        header.setFixedHeight(HEADER_PX)
        row = QHBoxLayout(header)
        row.setContentsMargins(14, 4, 10, 4)
        self.badge, self.alarm, self.user = label("", "badge"), QPushButton(""), QPushButton("")
        self.alarm.setObjectName("flat")
        self.alarm.clicked.connect(lambda: self.go(PageKey.ALARMS))
        self.user.setObjectName("flat")
        self.user.clicked.connect(lambda: self.go(PageKey.SETUP))
        row.addWidget(label("weldgate", "title"))
        row.addWidget(self.badge)
        row.addWidget(self.alarm)
        row.addStretch(1)
        row.addWidget(self.user)
        other = next(name for name in words.LANGUAGES if name != words.language())
        self._language, self._theme = QPushButton(words.LANGUAGES[other]), QPushButton("◐")
        self._language.clicked.connect(lambda: self.speak(other))
        self._theme.setToolTip(translate("window", "Switch between dark and light"))
        self._theme.clicked.connect(lambda: self.dress("light" if theme.name() == "dark" else "dark"))
        self.keyboard = QPushButton("⌨")
        self.keyboard.setCheckable(True)
        self.keyboard.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.keyboard.setToolTip(translate("window", "Keyboard on the screen"))
        self.keyboard.toggled.connect(self._show_keys)
        for button in (self.keyboard, self._language, self._theme):
            row.addWidget(button)
        return header

    def _show_keys(self, on: bool) -> None:
        """Show or remove the keyboard on the screen; most stations have a real one."""
        if on:
            self._foot.addWidget(Keys())
        elif (item := self._foot.takeAt(0)) is not None and (keys := item.widget()) is not None:
            keys.deleteLater()

    @property
    def shown(self) -> PageKey:
        """Key of the page that is shown."""
        return PAGES[self._stack.currentIndex()].key

    @property
    def page(self) -> Page:
        """The page that is shown."""
        return self._pages[self.shown]

    def go(self, key: PageKey) -> None:
        """Show a page."""
        if key not in self._pages:
            load = next(info.load for info in PAGES if info.key is key)
            self._pages[key] = load(self.session)
            self._places[key].addWidget(scrolled(self._pages[key]))
        self._stack.setCurrentWidget(self._places[key])
        self.buttons[key].setChecked(True)

    def _open_part(self, number: int) -> None:
        self.go(PageKey.HISTORY)
        self.page.open_part(number)

    def speak(self, language: str) -> None:
        """Show everything in another language."""
        self._rebuild(lambda: words.use(language))

    def dress(self, name: str) -> None:
        """Show everything in another theme."""
        self._rebuild(lambda: theme.use(name))

    def _rebuild(self, change: Callable[[], None]) -> None:
        shown = self.shown
        self._close_pages()
        change()
        self._build(shown)

    def _on_status(self) -> None:
        session, status = self.session, self.session.received.status
        self.badge.setVisible(status is not None and status.origin is not Origin.CAMERA)
        simulated = status is not None and status.origin is Origin.SIMULATED
        self.badge.setText(
            translate("window", "SIMULATED CAMERA") if simulated else translate("window", "REPLAY")
        )
        active = status.alarms if status is not None and session.received.engine_there else ()
        if not session.received.engine_there:
            text = translate("window", "No connection to the engine. Reconnecting...")
        else:
            text = data(TEXTS[active[0]].cause) if active else ""
        more = f" (+{len(active) - 1})" if len(active) > 1 else ""
        self.alarm.setText(f"⚠ {text}{more}" if text else "")
        self.alarm.setVisible(bool(text))
        count = f" ({len(active)})" if active else ""
        title = next(info.title() for info in PAGES if info.key is PageKey.ALARMS)
        self.buttons[PageKey.ALARMS].setText(f"{title}{count}")

    def _on_user(self) -> None:
        user = self.session.account.user
        self.user.setText(translate("window", "Log in") if user is None else f"{user.name}")
        app = QApplication.instance()
        if app is not None:  # a filter sees every event: only while it matters
            app.removeEventFilter(self)
            if user is not None:
                app.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Note each touch, click and key press, which keep the user logged in."""
        if event.type() in (QEvent.Type.MouseButtonPress, QEvent.Type.KeyPress, QEvent.Type.TouchBegin):
            self.session.account.touched()
        return super().eventFilter(watched, event)

    def _close_pages(self) -> None:
        for page in self._pages.values():
            page.close_page()
            page.setParent(None)
            page.deleteLater()
        self._pages = {}

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 - Qt's name
        """Stop timers and work and close the channel when the window is closed."""
        app = QApplication.instance()
        if app is not None:
            app.removeEventFilter(self)
        self._ageing.stop()
        for page in self._pages.values():
            page.close_page()
        self.session.close()
        super().closeEvent(event)

"""The shell: header, a button for each page, the page.

A page is made when it is first looked at, so that the window opens fast; language and theme are changed by making pages anew from
the session.
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
from station.panel.pages.live.page import LivePage
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import label, scrolled
from station.panel.widgets.keys import Keys
from station.plc.map.alarms import TEXTS

AGE_MS = 500
NAV_PX, HEADER_PX = 170, 56


def _history(session: Session) -> Page:
    from station.panel.pages.history.page import HistoryPage

    return HistoryPage(session)


def _statistics(session: Session) -> Page:
    from station.panel.pages.statistics.page import StatisticsPage

    return StatisticsPage(session)


def _line(session: Session) -> Page:
    from station.panel.pages.line.page import LinePage

    return LinePage(session)


def _alarms(session: Session) -> Page:
    from station.panel.pages.alarms.page import AlarmsPage

    return AlarmsPage(session)


def _setup(session: Session) -> Page:
    from station.panel.pages.setup.page import SetupPage

    return SetupPage(session)


def _replay(session: Session) -> Page:
    from station.panel.pages.replay.page import ReplayPage

    return ReplayPage(session)


PAGES: tuple[Callable[[Session], Page], ...] = (LivePage, _history, _statistics, _line, _alarms, _setup, _replay)


class Window(QMainWindow):
    """The operator's window."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self.setWindowTitle("weldgate")
        self.setMinimumSize(1180, 720)
        self.resize(1280, 800)
        self._pages: dict[int, Page] = {}
        """Those that were looked at."""
        self._build(0)
        session.received.status_changed.connect(self._on_status)
        session.account.changed.connect(self._on_user)
        session.part_wanted.connect(self._open_part)
        self._ageing = QTimer(self)
        self._ageing.timeout.connect(self._on_status)
        self._ageing.start(AGE_MS)
        for index in range(len(PAGES)):
            QShortcut(QKeySequence(f"F{index + 1}"), self, lambda i=index: self.go(i))

    def _build(self, chosen: int) -> None:
        """All widgets in the language and theme in use."""
        self._names = [
            translate("window", "Live"),
            translate("window", "History"),
            translate("window", "Statistics"),
            translate("window", "Line"),
            translate("window", "Alarms"),
            translate("window", "Setup"),
            translate("window", "Replay"),
        ]
        self._stack = QStackedWidget()
        nav = QFrame()
        self._buttons = QButtonGroup(nav)
        nav.setObjectName("nav")
        nav.setFixedWidth(NAV_PX)
        column = QVBoxLayout(nav)
        column.setContentsMargins(0, 6, 0, 6)
        column.setSpacing(0)
        self._places: list[QStackedWidget] = []
        for index, name in enumerate(self._names):
            button = QPushButton(name)
            button.setObjectName("nav")
            button.setCheckable(True)
            button.setToolTip(f"F{index + 1}")
            self._buttons.addButton(button, index)
            column.addWidget(button)
            place = QStackedWidget()
            self._places.append(place)
            self._stack.addWidget(place)
        column.addStretch(1)
        self._buttons.idClicked.connect(self.go)
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

    def _header(self) -> QFrame:
        header = QFrame()
        header.setObjectName("header")
        header.setFixedHeight(HEADER_PX)
        row = QHBoxLayout(header)
        row.setContentsMargins(14, 4, 10, 4)
        self._badge, self._alarm, self._user = label("", "badge"), QPushButton(""), QPushButton("")
        self._alarm.setObjectName("flat")
        self._alarm.clicked.connect(lambda: self.go(4))
        self._user.setObjectName("flat")
        self._user.clicked.connect(lambda: self.go(5))
        row.addWidget(label("weldgate", "title"))
        row.addWidget(self._badge)
        row.addWidget(self._alarm)
        row.addStretch(1)
        row.addWidget(self._user)
        other = next(name for name in words.LANGUAGES if name != words.language())
        self._language, self._theme = QPushButton(words.LANGUAGES[other]), QPushButton("◐")
        self._language.clicked.connect(lambda: self.speak(other))
        self._theme.setToolTip(translate("window", "dark or light"))
        self._theme.clicked.connect(lambda: self.dress("light" if theme.name() == "dark" else "dark"))
        self._typing = QPushButton("⌨")
        self._typing.setCheckable(True)
        self._typing.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._typing.setToolTip(translate("window", "keys on the screen"))
        self._typing.toggled.connect(self._type)
        for button in (self._typing, self._language, self._theme):
            row.addWidget(button)
        return header

    def _type(self, wanted: bool) -> None:
        """Made when asked for: most windows have a keyboard."""
        if wanted:
            self._foot.addWidget(Keys())
        elif (item := self._foot.takeAt(0)) is not None and (keys := item.widget()) is not None:
            keys.deleteLater()

    @property
    def page(self) -> Page:
        """The page that is shown."""
        return self._pages[self._stack.currentIndex()]

    def go(self, index: int) -> None:
        """Show a page: 0 live, 1 history, 2 statistics, 3 line, 4 alarms, 5 setup, 6 replay."""
        if index not in self._pages:
            self._pages[index] = PAGES[index](self.session)
            self._places[index].addWidget(scrolled(self._pages[index]))
        self._stack.setCurrentIndex(index)
        self._buttons.button(index).setChecked(True)

    def _open_part(self, number: int) -> None:
        self.go(1)
        self.page.open_part(number)  # type: ignore[attr-defined]

    def speak(self, language: str) -> None:
        """Another language, at once."""
        self._anew(lambda: words.use(language))

    def dress(self, name: str) -> None:
        """Another theme, at once."""
        self._anew(lambda: theme.use(name))

    def _anew(self, change: Callable[[], None]) -> None:
        chosen = self._stack.currentIndex()
        self._close_pages()
        change()
        self._build(chosen)

    def _on_status(self) -> None:
        session, status = self.session, self.session.received.status
        self._badge.setVisible(status is not None and status.origin is not Origin.CAMERA)
        simulated = status is not None and status.origin is Origin.SIMULATED
        self._badge.setText(translate("window", "SIMULATED CAMERA") if simulated else translate("window", "REPLAY"))
        lasting = status.alarms if status is not None and session.received.engine_there else ()
        if not session.received.engine_there:
            text = translate("window", "no word from the engine; it is connected again by itself")
        else:
            text = data(TEXTS[lasting[0]].cause) if lasting else ""
        more = f" (+{len(lasting) - 1})" if len(lasting) > 1 else ""
        self._alarm.setText(f"⚠ {text}{more}" if text else "")
        self._alarm.setVisible(bool(text))
        alarms = f"{self._names[4]} ({len(lasting)})" if lasting else self._names[4]
        self._buttons.button(4).setText(alarms)

    def _on_user(self) -> None:
        user = self.session.account.user
        self._user.setText(translate("window", "Log in") if user is None else f"{user.name}")
        app = QApplication.instance()
        if app is not None:  # every event of the application passes a filter: only while it matters
            app.removeEventFilter(self)
            if user is not None:
                app.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:  # noqa: N802 - Qt's name
        """Any touch or key keeps who is logged in."""
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
        """Stop timers, work and channel."""
        app = QApplication.instance()
        if app is not None:
            app.removeEventFilter(self)
        self._ageing.stop()
        for page in self._pages.values():
            page.close_page()
        self.session.close()
        super().closeEvent(event)

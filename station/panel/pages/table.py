"""The pages of the window in the order of their buttons: key, title and constructor."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

from station.panel.look.words import translate
from station.panel.pages.live.page import LivePage
from station.panel.pages.page import Page
from station.panel.session.session import Session


class PageKey(StrEnum):
    """Name of a page in code and tests."""

    LIVE = "live"
    HISTORY = "history"
    STATISTICS = "statistics"
    LINE = "line"
    ALARMS = "alarms"
    SETUP = "setup"
    REPLAY = "replay"


@dataclass(frozen=True, slots=True)
class PageInfo:
    """One page of the window."""

    key: PageKey
    title: Callable[[], str]
    """Function that returns the title in the language in use."""
    load: Callable[[Session], Page]
    """Function that imports and builds the page when it is first shown."""


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


PAGES: tuple[PageInfo, ...] = (
    PageInfo(PageKey.LIVE, lambda: translate("window", "Live"), LivePage),
    PageInfo(PageKey.HISTORY, lambda: translate("window", "History"), _history),
    PageInfo(PageKey.STATISTICS, lambda: translate("window", "Statistics"), _statistics),
    PageInfo(PageKey.LINE, lambda: translate("window", "Line"), _line),
    PageInfo(PageKey.ALARMS, lambda: translate("window", "Alarms"), _alarms),
    PageInfo(PageKey.SETUP, lambda: translate("window", "Setup"), _setup),
    PageInfo(PageKey.REPLAY, lambda: translate("window", "Replay"), _replay),
)
"""All pages; the first is shown at the start. F1 goes to the first page, F2 to the second, and so on."""

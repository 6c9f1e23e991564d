"""Pages that follow what they show: read again while somebody can see them, and not afterwards."""

from pytestqt.qtbot import QtBot

from station.panel.pages.page import FollowingPage


class Counting(FollowingPage):
    def __init__(self) -> None:
        super().__init__()
        self.count = 0

    def refresh(self) -> None:
        self.count += 1


def test_a_page_is_refreshed_at_once_and_then_while_it_is_visible(qtbot: QtBot) -> None:
    page = Counting()
    qtbot.addWidget(page)
    page.follow(1)
    assert page.count == 1
    with qtbot.waitSignal(page.timer.timeout, timeout=5000):
        pass
    assert page.count == 1, "nobody sees it"
    page.show()
    qtbot.waitUntil(lambda: page.count >= 3, timeout=5000)
    page.close_page()
    assert not page.timer.isActive()

"""Long work beside the window: progress, cancel, failures in words, nothing left running."""

import threading
import time
from collections.abc import Iterator

import pytest
from pytestqt.qtbot import QtBot

from station.errors import RecordError
from station.panel.widgets.work import Told, WorkBar


@pytest.fixture
def bar(qtbot: QtBot) -> Iterator[WorkBar]:
    made = WorkBar()
    qtbot.addWidget(made)
    yield made
    made.close_work()


def forever(told: Told) -> str:
    count = 0
    while told(count, 1000):
        count += 1
        time.sleep(0.005)
    return "cancelled"


def test_work_tells_its_progress_and_its_result(bar: WorkBar, qtbot: QtBot) -> None:
    with qtbot.waitSignal(bar.done, timeout=5000) as blocker:
        assert bar.start("counting", lambda told: [told(i, 3) for i in range(3)])
        assert bar.busy
        assert not bar.start("more", forever), "one thing at a time"
    assert blocker.args == [[True] * 3]
    assert not bar.busy
    assert bar.isHidden()


def test_cancelled_work_ends_soon_and_tells_nothing(bar: WorkBar, qtbot: QtBot) -> None:
    told: list[object] = []
    bar.done.connect(told.append)
    bar.start("counting", forever)
    qtbot.waitUntil(lambda: bar._bar.value() > 3, timeout=5000)
    bar._cancel.click()
    qtbot.waitUntil(lambda: not bar.busy, timeout=5000)
    assert not told


@pytest.mark.parametrize(("error", "said"), [(RecordError("disk full"), "disk full"), (KeyError("x"), "KeyError: 'x'")])
def test_work_that_fails_says_why(bar: WorkBar, qtbot: QtBot, error: Exception, said: str) -> None:
    def fails(_told: Told) -> None:
        raise error

    with qtbot.waitSignal(bar.failed, timeout=5000) as blocker:
        bar.start("failing", fails)
    assert blocker.args == [said]
    assert not bar.busy


def test_closing_ends_the_work(bar: WorkBar, qtbot: QtBot) -> None:
    bar.start("counting", forever)
    bar.close_work()
    assert "work" not in [thread.name for thread in threading.enumerate()]

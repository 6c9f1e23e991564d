"""Long work next to the window: progress, cancel, failures in words, nothing left running."""

import threading
import time
from collections.abc import Iterator

import pytest
from pytestqt.qtbot import QtBot

from station.errors import RecordError
from station.panel.widgets.work import Progress, WorkBar


@pytest.fixture
def bar(qtbot: QtBot) -> Iterator[WorkBar]:
    made = WorkBar()
    qtbot.addWidget(made)
    yield made
    made.close_work()


def forever(progress: Progress) -> str:
    count = 0
    while progress(count, 1000):
        count += 1
        time.sleep(0.005)
    return "cancelled"


def test_the_result_of_work_is_handed_over_on_the_thread_of_the_window(bar: WorkBar, qtbot: QtBot) -> None:
    results: list[tuple[list[bool], bool, threading.Thread]] = []

    def take(result: list[bool]) -> None:
        results.append((result, bar.busy, threading.current_thread()))

    assert bar.start("counting", lambda progress: [progress(i, 3) for i in range(3)], take)
    assert bar.busy
    with qtbot.waitSignal(bar.failed, timeout=5000):
        assert not bar.start("more", forever, results.append), "one job at a time"
    qtbot.waitUntil(lambda: bool(results), timeout=5000)
    assert results == [([True] * 3, False, threading.main_thread())]
    assert bar.isHidden()


def test_each_job_hands_its_result_to_its_own_function(bar: WorkBar, qtbot: QtBot) -> None:
    words: list[str] = []
    numbers: list[int] = []
    assert bar.start("a word", lambda _: "word", words.append)
    qtbot.waitUntil(lambda: bool(words), timeout=5000)
    assert bar.start("a number", lambda _: 0, numbers.append)
    qtbot.waitUntil(lambda: bool(numbers), timeout=5000)
    assert (words, numbers) == (["word"], [0])


def test_the_next_job_may_be_started_by_the_result_of_the_one_before(bar: WorkBar, qtbot: QtBot) -> None:
    results: list[int] = []

    def take(result: int) -> None:
        results.append(result)
        if result < 3:
            assert bar.start("more", lambda _: result + 1, take)

    bar.start("first", lambda _: 1, take)
    qtbot.waitUntil(lambda: results == [1, 2, 3], timeout=5000)
    assert not bar.busy


def test_cancelled_work_ends_soon_and_hands_nothing_over(bar: WorkBar, qtbot: QtBot) -> None:
    results: list[object] = []
    bar.start("counting", forever, results.append)
    qtbot.waitUntil(lambda: bar.bar.value() > 3, timeout=5000)
    bar.cancel_button.click()
    qtbot.waitUntil(lambda: not bar.busy, timeout=5000)
    assert not results


def test_none_means_that_there_is_no_result(bar: WorkBar, qtbot: QtBot) -> None:
    results: list[object] = []
    bar.start("nothing", lambda _: None, results.append)
    qtbot.waitUntil(lambda: not bar.busy, timeout=5000)
    assert not results


FAILURES = [(RecordError("disk full"), "disk full"), (KeyError("x"), "KeyError: 'x'")]


@pytest.mark.parametrize(("error", "message"), FAILURES)
def test_work_that_fails_says_why(bar: WorkBar, qtbot: QtBot, error: Exception, message: str) -> None:
    results: list[object] = []

    def fails(_progress: Progress) -> str:
        raise error

    with qtbot.waitSignal(bar.failed, timeout=5000) as blocker:
        bar.start("failing", fails, results.append)
    assert blocker.args == [message]
    assert not bar.busy
    assert not results


def test_closing_ends_the_work(bar: WorkBar) -> None:
    bar.start("counting", forever, print)
    bar.close_work()
    assert "work" not in [thread.name for thread in threading.enumerate()]


def test_a_result_that_waits_when_the_page_closes_is_dropped(bar: WorkBar, qtbot: QtBot) -> None:
    results: list[object] = []
    bar.start("short", lambda _: "late", results.append)
    assert bar._job is not None
    bar._job.thread.join()
    bar.close_work()
    assert bar.start("next", lambda _: "new", results.append)
    qtbot.waitUntil(lambda: not bar.busy, timeout=5000)
    assert results == ["new"]

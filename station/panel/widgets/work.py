"""Runs long work next to the window: with progress, with a button to cancel, one job at a time."""

import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QWidget

from station.errors import WeldgateError
from station.panel.look.words import translate
from station.panel.widgets.progress import Progress

Result = TypeVar("Result")
Work = Callable[[Progress], Result | None]
"""Function that does the work and returns its result, or None if it was cancelled."""


@dataclass(slots=True)
class _Outcome(Generic[Result]):
    """Result of a job, or why it failed; written on its thread, read on the window's once it has ended."""

    result: Result | None = None
    problem: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _Job:
    """A running job, and what happens on the window's thread once it has ended."""

    thread: threading.Thread
    finish: Callable[[], None]
    cancelled: threading.Event = field(default_factory=threading.Event)
    closed: threading.Event = field(default_factory=threading.Event)
    """Set when the window no longer waits for it."""


class WorkBar(QWidget):
    """A progress bar with a button to cancel; hidden while nothing runs."""

    failed = Signal(str)
    """Why the work failed or could not be started."""
    _moved = Signal(int, int)
    _ended = Signal(object)

    def __init__(self) -> None:
        super().__init__()
        self.bar, self._label = QProgressBar(), QLabel()
        self.cancel_button = QPushButton(translate("work", "Cancel"))
        self.cancel_button.clicked.connect(self.cancel)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        for widget, stretch in ((self._label, 0), (self.bar, 1), (self.cancel_button, 0)):
            row.addWidget(widget, stretch)
        self._job: _Job | None = None
        self._moved.connect(self._on_moved)
        self._ended.connect(self._on_ended)
        self.hide()

    @property
    def busy(self) -> bool:
        """True if a job is running."""
        return self._job is not None

    def start(self, title: str, work: Work[Result], then: Callable[[Result], object]) -> bool:
        """Run `work` on a thread of its own and hand its result to `then` on this one.

        `then` is not called if the work failed or was cancelled. Return False, and emit `failed`, if another
        job is running.
        """
        if self._job is not None:
            self.failed.emit(translate("work", "Another job is still running. Wait for it or cancel it."))
            return False
        outcome = _Outcome[Result]()

        def finish() -> None:
            if outcome.problem:
                self.failed.emit(outcome.problem)
            elif outcome.result is not None and not job.cancelled.is_set():
                then(outcome.result)

        def progress(done: int, total: int) -> bool:
            self._moved.emit(done, total)
            return not job.cancelled.is_set()

        def run() -> None:
            try:
                outcome.result = work(progress)
            except (WeldgateError, OSError) as error:
                outcome.problem = str(error)
            except Exception as error:  # noqa: BLE001 - the window continues
                outcome.problem = f"{type(error).__name__}: {error}"
            if not job.closed.is_set():
                self._ended.emit(job)

        self._job = job = _Job(threading.Thread(target=run, name="work", daemon=True), finish)
        self._label.setText(title)
        self.bar.setRange(0, 0)
        self.show()
        job.thread.start()
        return True

    def cancel(self) -> None:
        """Ask the job to end; it does so when it next reports its progress."""
        if self._job is not None:
            self._job.cancelled.set()

    def close_work(self) -> None:
        """Cancel the job and wait for it briefly; its result is dropped.

        A job that does not report its progress ends with the step that it is in.
        """
        if self._job is not None:
            job, self._job = self._job, None
            job.closed.set()
            job.cancelled.set()
            job.thread.join(timeout=1)

    def _on_moved(self, done: int, total: int) -> None:
        self.bar.setRange(0, total)
        self.bar.setValue(done)

    def _on_ended(self, job: _Job) -> None:
        if job is not self._job:
            return  # closed after it had ended
        job.thread.join()
        self._job = None
        self.hide()
        job.finish()

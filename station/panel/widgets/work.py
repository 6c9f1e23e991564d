"""Long work beside the window: with progress, can be cancelled, one at a time for its owner."""

import threading
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QLabel, QProgressBar, QPushButton, QWidget

from station.errors import WeldgateError
from station.panel.look.words import translate

Told = Callable[[int, int], bool]
"""Called by the work with how much is done of how much; False: cancelled, end soon."""


class WorkBar(QWidget):
    """A progress bar with a button to cancel; hidden while there is nothing to do."""

    done = Signal(object)
    """What the work returned; not after a cancel."""
    failed = Signal(str)
    _moved = Signal(int, int)
    _ended = Signal(object, str, bool)

    def __init__(self) -> None:
        super().__init__()
        self._bar, self._label = QProgressBar(), QLabel()
        self._cancel = QPushButton(translate("work", "Cancel"))
        self._cancel.clicked.connect(self.cancel)
        row = QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        for widget, stretch in ((self._label, 0), (self._bar, 1), (self._cancel, 0)):
            row.addWidget(widget, stretch)
        self._thread: threading.Thread | None = None
        self._cancelled = threading.Event()
        self._moved.connect(self._on_moved)
        self._ended.connect(self._on_ended)
        self.hide()

    @property
    def busy(self) -> bool:
        """Whether something is being done."""
        return self._thread is not None

    def start(self, what: str, work: Callable[[Told], Any]) -> bool:
        """False, and said, if something is still being done."""
        if self._thread is not None:
            self.failed.emit(translate("work", "something is still being done: wait for it or cancel it"))
            return False
        self._cancelled = cancelled = threading.Event()
        self._label.setText(what)
        self._bar.setRange(0, 0)
        self.show()

        def told(done: int, of: int) -> bool:
            self._moved.emit(done, of)
            return not cancelled.is_set()

        def run() -> None:
            result, problem = None, ""
            try:
                result = work(told)
            except (WeldgateError, OSError) as error:
                problem = str(error)
            except Exception as error:  # noqa: BLE001 - the window goes on
                problem = f"{type(error).__name__}: {error}"
            if not closing.is_set():
                self._ended.emit(result, problem, cancelled.is_set())

        closing = self._closing = threading.Event()
        self._thread = threading.Thread(target=run, name="work", daemon=True)
        self._thread.start()
        return True

    def cancel(self) -> None:
        """The work ends as soon as it looks."""
        self._cancelled.set()

    def close_work(self) -> None:
        """Cancel and wait a little; nothing is told any more. What does not look whether it is cancelled ends with its step."""
        if self._thread is not None:
            self._closing.set()
            self._cancelled.set()
            self._thread.join(timeout=1)
            self._thread = None

    def _on_moved(self, done: int, of: int) -> None:
        self._bar.setRange(0, of)
        self._bar.setValue(done)

    def _on_ended(self, result: Any, problem: str, cancelled: bool) -> None:
        if self._thread is not None:
            self._thread.join()
            self._thread = None
        self.hide()
        if problem:
            self.failed.emit(problem)
        elif not cancelled:
            self.done.emit(result)

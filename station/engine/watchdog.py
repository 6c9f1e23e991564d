"""Ends the engine if a thread hangs or if it does not stop in time; the service manager restarts it.

A thread that hangs in a driver cannot be ended from inside: only a new process is sure to be free of it.
"""

import faulthandler
import logging
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from types import FrameType
from typing import NoReturn

from station.engine.check_ins import CheckIns

log = logging.getLogger("weldgate.watchdog")

TICK_S = 0.5
"""Interval at which the signs of life are looked at."""
STOP_S = 15.0
"""Time within which the engine stops after SIGTERM or SIGINT."""
LAST_WORDS_S = 2.0
"""Time for what is to be done before the end: the log or the disk may hang too."""
HUNG = 70
"""Exit code of an engine that ended itself (EX_SOFTWARE)."""

Step = Callable[[], None]


def nothing() -> None:
    """Do nothing."""


def notify(state: str) -> None:
    """Send a state to the service manager (sd_notify); do nothing if there is none."""
    address = os.environ.get("NOTIFY_SOCKET", "")
    if not address:
        return
    name = "\0" + address[1:] if address.startswith("@") else address
    with suppress(OSError), socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as unix:
        unix.setblocking(False)
        unix.sendto(state.encode(), name)


def end(why: str, last_steps: Step = nothing) -> NoReturn:
    """Log why, and what each thread does, carry out the last steps, and end the process at once."""

    def last_words() -> None:
        log.critical("%s; the engine ends itself", why)
        with suppress(OSError, ValueError):
            faulthandler.dump_traceback(sys.stderr)
        try:
            last_steps()
        except Exception:  # the end comes all the same
            log.exception("the last steps failed")

    thread = threading.Thread(target=last_words, name="last words", daemon=True)
    thread.start()
    thread.join(LAST_WORDS_S)
    os._exit(HUNG)


class Watchdog:
    """A thread that looks at the signs of life, and passes them on to the service manager."""

    def __init__(
        self,
        check_ins: CheckIns,
        last_steps: Step = nothing,
        *,
        end: Callable[[str, Step], None] = end,
        tick_s: float = TICK_S,
    ) -> None:
        """`last_steps` is done before the engine is ended by `end`."""
        self._check_ins, self._last_steps, self._end, self._tick_s = check_ins, last_steps, end, tick_s
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="watchdog", daemon=True)
        self._thread.start()
        notify("READY=1")

    def close(self) -> None:
        """End the thread."""
        self._stop.set()
        self._thread.join(timeout=10)

    def _run(self) -> None:
        while not self._stop.wait(self._tick_s):
            overdue = self._check_ins.overdue()
            if overdue:
                names = ", ".join(f"{name} ({late_s:.1f} s late)" for name, late_s in overdue.items())
                self._end(f"no sign of life: {names}", self._last_steps)
                return
            notify("WATCHDOG=1")


class StopSignals:
    """Sets an event on SIGTERM and SIGINT, also while the main thread hangs in a driver. Use as a context.

    Python runs its handlers in the main thread only; the number of the signal comes through a socket too.
    """

    def __init__(
        self, stop: threading.Event, last_steps: Step = nothing, *, within_s: float = STOP_S
    ) -> None:
        """`last_steps` is done if the context is not left `within_s` after the signal."""
        self._stop, self._last_steps, self._within_s = stop, last_steps, within_s
        self._left = threading.Event()

    def __enter__(self) -> "StopSignals":
        """Install the handlers; call from the main thread."""
        self._reader, self._writer = socket.socketpair()
        self._writer.setblocking(False)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._on_signal)
        self._previous = signal.set_wakeup_fd(self._writer.fileno(), warn_on_full_buffer=False)
        self._thread = threading.Thread(target=self._wait, name="signals", daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End the thread; the handlers stay, so that a second signal does not end the process early."""
        self._left.set()
        signal.set_wakeup_fd(self._previous)
        self._writer.close()
        self._thread.join(timeout=10)
        self._reader.close()

    def _on_signal(self, _number: int, _frame: FrameType | None) -> None:
        self._stop.set()

    def _wait(self) -> None:
        while received := self._reader.recv(1):
            if received[0] not in (signal.SIGINT, signal.SIGTERM):
                continue
            self._stop.set()
            notify("STOPPING=1")
            if not self._left.wait(self._within_s):
                end(f"not stopped within {self._within_s:g} s after a signal", self._last_steps)
            return

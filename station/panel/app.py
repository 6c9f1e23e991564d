"""The process that shows the window."""

import os
import signal
import sys
from pathlib import Path

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from station.channel.request_socket import RequestClient
from station.channel.zeromq import Subscriber
from station.errors import WeldgateError
from station.panel.look import theme, words
from station.panel.session.bridge import Bridge
from station.panel.session.session import Session
from station.panel.window import Window
from station.settings.file import load


def open_window(path: Path) -> Window:
    """Return the window for a settings file, not yet shown. A QApplication must exist.

    Raises SettingsError, LineError if this account may not use the channel.
    """
    settings = load(path)
    words.use(settings.panel.language)
    theme.use(settings.panel.theme)
    bridge = Bridge(Subscriber(settings.channel), RequestClient(settings.channel))
    return Window(Session(bridge, settings, path))


def run_panel(path: Path) -> int:
    """Show the window until it is closed, or until SIGINT or SIGTERM. Raises WeldgateError."""
    if sys.platform == "linux" and not any(
        os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM")
    ):
        raise WeldgateError(
            "The window cannot be shown: there is no display. Set DISPLAY, or run 'weldgate engine' alone."
        )
    app = QApplication.instance() or QApplication(sys.argv[:1])
    window = open_window(path)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: QTimer.singleShot(0, window.close))  # not in the middle of a poll
    wake = QTimer()  # lets Python see signals while Qt waits
    wake.start(200)
    wake.timeout.connect(window.isVisible)
    window.show()
    return int(app.exec())

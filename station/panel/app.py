"""The panel's process."""

import signal
import sys

from PySide6.QtCore import QTimer
from PySide6.QtWidgets import QApplication

from station.channel import Subscriber
from station.panel.bridge import Bridge
from station.panel.window import Window
from station.settings import Settings


def run_panel(settings: Settings) -> int:
    """Show the window until it is closed, or until SIGINT or SIGTERM."""
    app = QApplication.instance() or QApplication(sys.argv[:1])
    window = Window(Bridge(Subscriber(settings.channel)))
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: window.close())
    wake = QTimer()  # lets Python see signals while Qt waits
    wake.start(200)
    wake.timeout.connect(window.isVisible)
    window.show()
    return int(app.exec())

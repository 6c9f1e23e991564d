"""Puts the views together; no logic of its own but the ageing of the lamp."""

import time

from PySide6.QtCore import QTimer
from PySide6.QtGui import QCloseEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QMainWindow, QPushButton, QVBoxLayout, QWidget

from station.domain import Origin
from station.events import PartEvent, Preview, StatusEvent
from station.panel import theme
from station.panel.bridge import Bridge
from station.panel.lamp_state import STATUS_LOST_S, lamp
from station.panel.live_view import LiveView
from station.panel.strip_view import StripView
from station.panel.verdict_lamp import VerdictLamp

AGE_MS = 200
FACTS = ("part", "serial", "trigger", "inspection", "cycle", "picture", "camera", "parts", "OK", "NOK", "not judged", "yield")


class Window(QMainWindow):
    """The operator's window."""

    def __init__(self, bridge: Bridge) -> None:
        super().__init__()
        self._bridge = bridge
        self._status: StatusEvent | None = None
        self._status_s = self._part_s = -1e9
        self._part: PartEvent | None = None
        self.setWindowTitle("weldgate")
        self.setStyleSheet(theme.STYLE)
        self._live, self._strip, self._lamp = LiveView(), StripView(), VerdictLamp()
        self._badge = QLabel("SIMULATED CAMERA")
        self._badge.setObjectName("badge")
        self._badge.hide()
        self._test = QPushButton("Test picture")
        self._test.setObjectName("action")
        self._test.setToolTip("Take a picture of what lies there now and judge it; the PLC is told nothing")
        self._test.clicked.connect(bridge.ask_for_test_picture)
        self._facts = {name: QLabel("–") for name in FACTS}
        self._lay_out()
        bridge.status.connect(self._on_status)
        bridge.part.connect(self._on_part)
        bridge.preview.connect(self._on_preview)
        self._clock = QTimer(self)
        self._clock.timeout.connect(self._age)
        self._clock.start(AGE_MS)
        self._age()
        self.resize(1280, 800)

    def _lay_out(self) -> None:
        side = QVBoxLayout()
        side.addWidget(self._badge)
        side.addWidget(self._lamp, 2)
        side.addWidget(self._card(FACTS[:7]))
        side.addWidget(self._card(FACTS[7:]))
        side.addWidget(self._test)
        top = QHBoxLayout()
        top.addWidget(self._live, 5)
        column = QWidget()
        column.setMinimumWidth(360)
        side.setContentsMargins(0, 0, 0, 0)
        column.setLayout(side)
        top.addWidget(column, 2)
        page = QVBoxLayout()
        page.addLayout(top, 1)
        page.addWidget(self._strip)
        body = QWidget()
        body.setLayout(page)
        self.setCentralWidget(body)

    def _card(self, names: tuple[str, ...]) -> QFrame:
        card = QFrame()
        card.setObjectName("card")
        grid = QGridLayout(card)
        grid.setVerticalSpacing(4)
        for row, name in enumerate(names):
            label = QLabel(name)
            label.setObjectName("quiet")
            grid.addWidget(label, row, 0)
            self._facts[name].setObjectName("value" if name in ("OK", "NOK", "parts") else "fact")
            grid.addWidget(self._facts[name], row, 1)
        grid.setColumnStretch(1, 1)
        return card

    def _on_status(self, event: StatusEvent) -> None:
        self._status, self._status_s = event, time.monotonic()
        self._badge.setVisible(event.origin is not Origin.CAMERA)
        self._badge.setText("SIMULATED CAMERA" if event.origin is Origin.SIMULATED else "REPLAY")
        counts = event.counts
        self._facts["camera"].setText("there" if event.camera_there else "lost")
        self._facts["parts"].setText(str(counts.total))
        self._facts["OK"].setText(str(counts.ok))
        self._facts["NOK"].setText(str(counts.nok))
        self._facts["not judged"].setText(str(counts.error))
        self._facts["yield"].setText(f"{counts.ok / counts.total:.1%}" if counts.total else "–")
        self._age()

    def _on_part(self, event: PartEvent) -> None:
        self._part, self._part_s = event, time.monotonic()
        record, timing = event.record, event.record.inspection.timing
        steps = (timing.grab_ms, timing.locate_ms, timing.unwrap_ms, timing.classify_ms, event.record_ms, event.publish_ms)
        self._facts["part"].setText(f"no. {record.inspection_id}")
        self._facts["serial"].setText(record.serial or "–")
        self._facts["trigger"].setText(str(record.trigger_id))
        self._facts["inspection"].setText(f"{record.grabbed_at:%H:%M:%S} UTC")
        drifting = event.drift is not None and event.drift.alarm
        self._facts["picture"].setText("UNLIKE TRAINING" if event.novel else "DRIFTING" if drifting else "known")
        self._facts["cycle"].setText(f"{sum(ms for ms in steps if ms is not None):.0f} ms")
        self._live.show_part(event)
        self._strip.show_part(event)
        self._age()

    def _on_preview(self, preview: Preview) -> None:
        self._live.show_preview(preview)
        self._strip.show_preview(preview)

    def _age(self) -> None:
        now = time.monotonic()
        there = self._status is not None and now - self._status_s <= STATUS_LOST_S and self._status.camera_there
        self._test.setEnabled(there)
        self._lamp.show_lamp(lamp(self._status, now - self._status_s, self._part, now - self._part_s))

    def closeEvent(self, event: QCloseEvent) -> None:  # noqa: N802 - Qt's name
        """Stop the timers and the channel."""
        self._clock.stop()
        self._bridge.close()
        super().closeEvent(event)

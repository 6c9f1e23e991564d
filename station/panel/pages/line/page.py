"""The page Line: bits, registers and edges between station and PLC, word order, bits set by hand."""

import struct
from collections import deque
from datetime import datetime
from enum import IntFlag

from PySide6.QtCore import QSignalBlocker, Qt, QTimer
from PySide6.QtGui import QShowEvent
from PySide6.QtWidgets import QFrame, QGridLayout, QHBoxLayout, QLabel, QPushButton, QSplitter, QVBoxLayout

from station.channel.requests import HoldService
from station.errors import RecordError
from station.journal.users import Level
from station.panel.look import theme
from station.panel.look.words import data, translate
from station.panel.pages.page import Page
from station.panel.session.session import Session
from station.panel.widgets.card import Choice, Table, label, titled
from station.plc.bus_log import Edge, tail_bus
from station.plc.map.registers import (
    BY_NAME,
    COMMAND_START,
    MAP,
    STATUS_START,
    Control,
    Offline,
    Status,
    Value,
    VerdictCode,
    unpack_window,
)

EDGES = 400
"""Maximum number of edges that are shown, the newest."""
REFRESH_MS = 500


class LinePage(Page):
    """Shows the status events and the recorded edges of the bus."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self._edges: deque[Edge] = deque(maxlen=EDGES)
        self._place: tuple[str, int] = ("", 0)
        self.lamps: dict[tuple[str, IntFlag], QLabel] = {}
        """Lamps by register and bit."""
        self.registers = Table(
            (translate("line", "register"), translate("line", "name"), translate("line", "value")), stretch=2
        )
        self.edges = Table(
            (
                translate("line", "time"),
                translate("line", "by"),
                translate("line", "signal"),
                translate("line", "value"),
                translate("line", "note"),
            ),
            stretch=4,
        )
        self._words = label("", "quiet", wrap=True)
        self.stale = label(
            translate("line", "No connection to the engine. The registers show their last values."), "problem"
        )
        self.stale.hide()
        self._problem = label("", "problem")
        self.service = QPushButton(translate("line", "Service mode"))
        self.service.setCheckable(True)
        self.service.clicked.connect(self._toggle_service)
        self.bits = Choice()
        self.bits.addItem(translate("line", "no bit"), 0)
        for flag in Status:
            self.bits.addItem(str(flag.name), int(flag))
        self.bits.currentIndexChanged.connect(self._set_bit)
        self._lay_out()
        session.received.status_changed.connect(self._on_status)
        session.service.changed.connect(self._on_service)
        session.service.refused.connect(self._on_refused)
        session.account.changed.connect(self._on_service)
        self._timer = QTimer(self)
        self._timer.timeout.connect(self._read_edges)
        self._timer.timeout.connect(self._on_status)
        self._timer.start(REFRESH_MS)
        self._on_status()
        self._on_service()
        self._read_edges()

    def _lay_out(self) -> None:
        bits = QFrame()
        bits.setObjectName("card")
        grid = QGridLayout(bits)
        grid.setSpacing(4)
        station, plc = data("station"), data("PLC")
        both: tuple[tuple[str, str, type[IntFlag]], ...] = (
            ("CONTROL", f"{plc} → {station}", Control),
            ("STATUS", f"{station} → {plc}", Status),
        )
        for row, (register, title, flags) in enumerate(both):
            grid.addWidget(label(title, "quiet"), row * 3, 0, 1, 8)
            for index, flag in enumerate(flags):
                lamp = QLabel(str(flag.name))
                lamp.setAlignment(Qt.AlignmentFlag.AlignCenter)
                lamp.setMinimumHeight(30)
                self.lamps[register, flag] = lamp
                grid.addWidget(lamp, row * 3 + 1 + index // 8, index % 8)
        hand = QHBoxLayout()
        for widget in (
            self.service,
            label(translate("line", "set one bit of STATUS by hand:"), "quiet"),
            self.bits,
            self._problem,
        ):
            hand.addWidget(widget)
        hand.addStretch(1)
        below = QSplitter(Qt.Orientation.Horizontal)
        below.addWidget(titled(translate("line", "registers"), self.registers))
        below.addWidget(titled(translate("line", "edges on the bus, newest first"), self.edges))
        below.setSizes([420, 660])
        column = QVBoxLayout(self)
        column.addWidget(bits)
        column.addLayout(hand)
        column.addWidget(self.stale)
        column.addWidget(self._words)
        column.addWidget(below, 1)

    def _on_status(self) -> None:
        status, there = self._session.received.status, self._session.received.engine_there
        if (
            status is None
            or not status.status_words
            or not (self.isVisible() or self.registers.rowCount() == 0)
        ):
            return
        self.stale.setVisible(not there)
        self.registers.setEnabled(there)
        values = unpack_window(COMMAND_START, list(status.command_words)) | unpack_window(
            STATUS_START, list(status.status_words)
        )
        bits = {"CONTROL": status.line.control, "STATUS": status.line.status}
        colors = theme.colors()
        for (register, flag), lamp in self.lamps.items():
            on = there and bool(flag & bits[register])
            symbol = "?" if not there else "●" if on else "○"
            text = f"{symbol} {flag.name}"
            if lamp.text() != text:
                lamp.setText(text)
                on_style = f"background: {colors.accent}; color: {colors.background}; font-weight: 700;"
                lamp.setStyleSheet(
                    "border-radius: 4px; font-size: 12px; "
                    + (on_style if on else f"background: {colors.raised};")
                )
        self.registers.fill(
            [
                (str(register.address), register.name, _shown(register.name, values[register.name]))
                for register in MAP
            ]
        )
        words = status.status_words
        for_u32, for_f32 = (
            words[BY_NAME[name].address - STATUS_START :][:2] for name in ("TEST_U32", "TEST_F32")
        )
        test_f32 = struct.unpack(">f", struct.pack(">HH", *for_f32))[0]
        if self._session.received.settings.plc.low_word_first:
            for_u32, for_f32 = for_u32[::-1], for_f32[::-1]
        self._words.setText(
            translate(
                "line",
                "Word order: the PLC must read TEST_U32 as 16#12345678 (305419896) and TEST_F32 as 123.456. "
                "Words sent:",
            )
            + f" {for_u32[0]:04X} {for_u32[1]:04X} · {for_f32[0]:04X} {for_f32[1]:04X} ({test_f32:.3f}). "
            + translate(
                "line", "If it reads 16#56781234, swap the words in the PLC or set plc.low_word_first."
            )
        )

    def _on_service(self) -> None:
        session = self._session
        self.service.setChecked(session.service.held is not None)
        self.service.setEnabled(session.account.may(Level.SETTER))
        self.bits.setEnabled(session.service.held is not None and session.account.may(Level.SETTER))
        hint = (
            ""
            if session.account.may(Level.SETTER)
            else translate("line", "Log in as setter first (page Setup).")
        )
        self._problem.setText(hint)
        with QSignalBlocker(self.bits):
            self.bits.setCurrentIndex(
                max(0, self.bits.findData(0 if session.service.held is None else session.service.held.bit))
            )

    def _toggle_service(self) -> None:
        session = self._session
        if session.service.held is not None:
            session.service.end()
        elif session.account.user is not None:
            self._hold(HoldService())

    def _set_bit(self) -> None:
        if self._session.service.held is not None:
            self._hold(HoldService(bit=int(self.bits.currentData())))

    def _hold(self, request: HoldService) -> None:
        for widget in (self.service, self.bits):
            widget.setEnabled(False)  # until the engine has answered
        self._session.service.hold(request)

    def _on_refused(self, why: str) -> None:
        self._on_service()
        self._problem.setText(data(why))

    def _read_edges(self) -> None:
        if not (self.isVisible() or not self._edges):
            return
        try:
            new, self._place = tail_bus(self._session.received.folder, self._place, EDGES)
        except RecordError as error:
            self._problem.setText(str(error))
            return
        if not new:
            return
        self._edges.extend(new)
        rows = [
            (
                _time(edge.time),
                data(edge.by),
                edge.name,
                str(edge.value),
                data(edge.note) if edge.note else "",
            )
            for edge in reversed(self._edges)
        ]
        self.edges.fill(rows)

    def showEvent(self, event: QShowEvent) -> None:  # noqa: N802 - Qt's name
        """Show at once what came while the page was hidden."""
        super().showEvent(event)
        self._on_status()

    def close_page(self) -> None:
        """Stop the timer."""
        self._timer.stop()


def _time(utc: str) -> str:
    return f"{datetime.fromisoformat(utc).astimezone():%H:%M:%S.%f}"[:-3]


def _shown(name: str, value: Value) -> str:
    if name == "VERDICT":
        return f"{value} {VerdictCode(int(str(value))).name}"
    if name == "OFFLINE_REASON":
        return f"{value} {Offline(int(str(value))).name}"
    if name in ("STATUS", "CONTROL", "ERROR_CODE", "CONFIG_CRC", "FLAGS", "VERDICT_INV"):
        return f"16#{int(str(value)):04X}"
    if isinstance(value, float):
        return f"{value:.3f}"
    return " ".join(map(str, value)) if isinstance(value, tuple) else str(value)

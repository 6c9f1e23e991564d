"""What the operator looks at: the picture, the lamp, the part, the last NOK, where defects lie."""

import time

from PySide6.QtCore import QTimer
from PySide6.QtGui import QHideEvent, QImage, QResizeEvent
from PySide6.QtWidgets import (
    QGridLayout,
    QHBoxLayout,
    QPushButton,
    QSizePolicy,
    QStackedWidget,
    QVBoxLayout,
    QWidget,
)

from station.channel.events import PartEvent
from station.channel.requests import Answer, TakeTestImage
from station.domain import SEGMENTS, Purpose
from station.journal.users import Level
from station.panel.look.words import data, translate
from station.panel.pages.live.score_history import ScoreHistory
from station.panel.pages.live.verdict_lamp import VerdictLamp
from station.panel.pages.page import Page
from station.panel.session.lamp import foot, lamp
from station.panel.session.received import shows
from station.panel.session.session import Session
from station.panel.widgets.card import Facts, label, titled
from station.panel.widgets.weld.clock_face import ClockFace
from station.panel.widgets.weld.pictures import drawn, nok_scores, strip_image
from station.panel.widgets.weld.strip_view import StripView
from station.panel.widgets.weld.weld_view import WeldView
from station.panel.widgets.work import Progress, WorkBar

AGE_MS = 200
SIDE_PX, SIDE_SHARE = 380, 0.32


class LivePage(Page):
    """Built from the session; follows it."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.weld, self.strip, self.lamp, self.clock = WeldView(), StripView(), VerdictLamp(), ClockFace()
        self.facts = Facts(
            {
                "part": translate("live", "part"),
                "serial": translate("live", "serial"),
                "recipe": translate("live", "recipe"),
                "cycle": translate("live", "cycle"),
                "picture": translate("live", "picture"),
                "parts": translate("live", "parts"),
                "ok": "OK",
                "nok": "NOK",
                "error": translate("live", "not judged"),
                "yield": translate("live", "yield"),
            },
            columns=2,
        )
        self._nok_strip, self._nok_text = StripView(70), label("–", "quiet")
        self._nok_shown: tuple[int, bool] | None = None
        """Number of the pinned part, and whether its picture had come."""
        self.scores, self._segment = ScoreHistory(), 0
        self.strip.touched.connect(self._show_scores)
        self._nok_strip.touched.connect(lambda _: self._open_pinned())
        self.scores.touched.connect(lambda: self._angles.setCurrentWidget(self.clock))
        self.test = QPushButton(translate("live", "Test picture"))
        self.test.setToolTip(
            translate("live", "Take a picture of what lies there now and judge it; the PLC is told nothing")
        )
        self.test.clicked.connect(self._ask_test)
        self.hold = QPushButton(translate("live", "Hold"))
        self.hold.setToolTip(translate("live", "The picture stays; lamp and counters go on"))
        self.hold.setCheckable(True)
        self.hold.toggled.connect(self._show_picture)
        self._held = False
        """Whether a picture stays."""
        self.show_map = QPushButton(translate("live", "Defect map"))
        self.show_map.setToolTip(translate("live", "Where the network sees defects in the last NOK part"))
        self.show_map.clicked.connect(self._ask_map)
        self._work = WorkBar()
        self._work.failed.connect(lambda why: self._nok_text.setText(data(why)))
        self._lay_out()
        session.received.status_changed.connect(self._on_status)
        session.received.part_came.connect(self._on_part)
        session.received.preview_came.connect(self._on_preview)
        session.account.changed.connect(self.age)
        self._ageing = QTimer(self)
        self._ageing.timeout.connect(self.age)
        self._ageing.start(AGE_MS)
        self._on_status()
        self._on_part()
        self._on_preview()
        self.age()

    def _lay_out(self) -> None:
        self._side = side = QWidget()
        side.setFixedWidth(SIDE_PX)
        column = QVBoxLayout(side)
        column.setContentsMargins(0, 0, 0, 0)
        column.addWidget(self.lamp, 4)
        column.addWidget(self.facts)
        self._angles = QStackedWidget()
        for widget in (self.clock, self.scores):
            self._angles.addWidget(widget)
        column.addWidget(titled(translate("live", "NOK segments of the last parts"), self._angles), 3)
        buttons = QHBoxLayout()
        for button in (self.test, self.show_map, self.hold):
            button.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
            buttons.addWidget(button)
        column.addLayout(buttons)
        pinned = QWidget()
        rows = QVBoxLayout(pinned)
        rows.setContentsMargins(0, 0, 0, 0)
        rows.addWidget(self._nok_strip)
        last = titled(translate("live", "last NOK"), pinned)
        foot = last.layout()
        if foot is not None:
            foot.addWidget(self._nok_text)
            foot.addWidget(self._work)
        grid = QGridLayout(self)
        grid.addWidget(self.weld, 0, 0)
        grid.addWidget(side, 0, 1, 2, 1)
        bottom = QVBoxLayout()
        bottom.addWidget(self.strip)
        bottom.addWidget(last)
        grid.addLayout(bottom, 1, 0)
        grid.setRowStretch(0, 1)
        grid.setColumnStretch(0, 1)

    def _on_status(self) -> None:
        status = self._session.received.status
        if status is None:
            return
        c = status.line.counts
        share = f"{c.ok / c.total:.1%}" if c.total else "–"
        self.facts.set(
            parts=c.total, ok=c.ok, nok=c.nok, error=c.error, recipe=status.recipe, **{"yield": share}
        )
        self.age()

    def _on_part(self) -> None:
        last = self._session.received.last
        if last is None:
            return
        event, record = last, last.record
        t = record.inspection.timing
        steps = (t.grab_ms, t.locate_ms, t.unwrap_ms, t.classify_ms, event.record_ms, event.publish_ms)
        drifting = event.drift is not None and event.drift.alarm
        known = translate("live", "known")
        picture = (
            translate("live", "UNLIKE TRAINING")
            if event.novel
            else translate("live", "DRIFTING")
            if drifting
            else known
        )
        cycle = f"{sum(ms for ms in steps if ms is not None):.0f} ms"
        self.facts.set(part=record.inspection_id, serial=record.serial or "–", picture=picture, cycle=cycle)
        counts = [0] * SEGMENTS
        for part in self._session.received.parts:
            for index, nok in enumerate(
                part.record.inspection.nok if part.record.purpose is Purpose.PART else ()
            ):
                counts[index] += nok
        self.clock.show_counts(tuple(counts))
        if self._angles.currentWidget() is self.scores:
            self._show_scores(self._segment)
        self._show_picture()
        self._show_pinned()
        self.age()

    def _on_preview(self) -> None:
        self._show_picture()
        self._show_pinned()

    def _show_pinned(self) -> None:
        pinned = self._session.received.last_nok
        self.show_map.setEnabled(pinned is not None and pinned.preview is not None)
        if pinned is not None:
            part, preview = pinned.part, pinned.preview
            shown = part.record.inspection_id, preview is not None
            if shown != self._nok_shown:
                self._nok_shown = shown
                self._nok_text.setText(_caption(part))
                self._nok_strip.show_strip(
                    None if preview is None else strip_image(preview),
                    nok_scores(part.record),
                    part.record.inspection.nok,
                )

    def _show_picture(self) -> None:
        """The last part's own picture; else, darkened, the one before, and said so."""
        last, preview = self._session.received.last, self._session.received.preview
        if last is None or (self.hold.isChecked() and self._held):
            return
        self._held = False
        if preview is not None and shows(preview, last):
            self._held = self.hold.isChecked()
            held = "  ·  " + translate("live", "HELD") if self._held else ""
            self.weld.show_weld(drawn(preview, last), caption=_caption(last) + held)
            self.strip.show_strip(strip_image(preview), nok_scores(last.record), last.record.inspection.nok)
        else:
            before = "" if preview is None else f"\n({preview.inspection_id})"
            note = translate("live", "no picture of this part") + before
            self.weld.show_weld(None if preview is None else drawn(preview, None), note)
            self.strip.show_strip(None, nok_scores(last.record), last.record.inspection.nok)

    def age(self) -> None:
        """Lamps fade with time."""
        session = self._session
        last, now = session.received.last, time.monotonic()
        status = session.received.status
        there = session.received.engine_there and status is not None and status.camera_there
        self.test.setEnabled(there and session.account.may(Level.OPERATOR))
        self.lamp.show_lamp(lamp(status, last, now), foot(last, now))

    def _ask_map(self) -> None:
        pinned = self._session.received.last_nok
        if pinned is None:
            return
        record, settings = pinned.part.record, self._session.received.settings

        def work(_progress: Progress) -> tuple[int, QImage]:
            from station.panel.widgets.weld.kept import defect_map  # only who asks pays for the network

            return defect_map(settings, record)

        self._work.start(translate("live", "defect map"), work, self._on_map)

    def _ask_test(self) -> None:
        self._session.account.ask(TakeTestImage(), self._on_test, self)

    def _on_test(self, answer: Answer) -> None:
        if not answer.done:
            self._nok_text.setText(data(answer.refusal))

    def _on_map(self, made: tuple[int, QImage]) -> None:
        number, overlay = made
        if (
            self._nok_shown is not None and self._nok_shown[0] == number
        ):  # or another part has been pinned since
            self._nok_strip.show_map(overlay)

    def _show_scores(self, segment: int) -> None:
        """Of the last parts, oldest first."""
        self._segment = segment
        seen = [
            p
            for p in self._session.received.parts
            if p.record.purpose is Purpose.PART and p.record.inspection.scores
        ]
        scores = [p.record.inspection.scores[segment].nok for p in seen]
        parts, name = translate("live", "parts"), translate("live", "segment")
        self.scores.show_scores(
            scores,
            [p.record.inspection.nok[segment] for p in seen],
            f"{name} {segment + 1} · {len(seen)} {parts}",
        )
        self._angles.setCurrentWidget(self.scores)

    def _open_pinned(self) -> None:
        if self._nok_shown is not None and self._nok_shown[0] > 0:
            self._session.part_chosen.emit(self._nok_shown[0])

    def resizeEvent(self, event: QResizeEvent) -> None:  # noqa: N802 - Qt's name
        """The lamp grows with the screen: it is read from afar."""
        super().resizeEvent(event)
        self._side.setFixedWidth(max(SIDE_PX, int(self.width() * SIDE_SHARE)))

    def hideEvent(self, event: QHideEvent) -> None:  # noqa: N802 - Qt's name
        """Nobody looks at what is held."""
        self.hold.setChecked(False)
        super().hideEvent(event)

    def close_page(self) -> None:
        """Nothing is left running."""
        self._ageing.stop()
        self._work.close_work()


def _caption(part: PartEvent) -> str:
    record = part.record
    return f"{record.inspection_id}  {record.serial}  {record.grabbed_at.astimezone():%H:%M:%S}"
